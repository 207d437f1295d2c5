"""Rows without a measurement count for no held-out error."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from toy import QUICK, SD, Toy, programme, record

from ves_twin.diagnosis.diagnose import diagnose
from ves_twin.diagnosis.unseen import held_out_gain as gain


def with_hole(first, last):
    """The verdict on a friction whose held-out recording has a hole."""
    hidden = {"friction.size": 0.1}
    once = record(np.random.default_rng(1), hidden, spread=0.0)
    other = record(np.random.default_rng(2), hidden, spread=0.0, fed=programme(9))
    out = other["out"].copy()
    out[first:last] = np.nan
    holed = replace(other, signals={**other.signals, "out": out})
    return diagnose(Toy(), [once], held_out=[holed], settings=QUICK)


def test_held_out_rms_counts_measured_rows_only():
    """The line across a hole is off by the whole motion; that is nobody's error."""
    verdict = with_hole(200, 360)
    for channel, sd in enumerate(SD):
        _, after = verdict.gain.errors[f"out.{channel}"]
        assert after == pytest.approx(sd, rel=0.5)


def test_a_gain_is_finite_where_many_stretches_have_no_row(monkeypatch):
    """Drawn alone, stretches without a sample made 0/0, and verdict.json could not be written."""
    monkeypatch.setattr(gain, "BLOCK_SECONDS", 2.0)  # one of four is empty: 8 of 2000 draws are
    verdict = with_hole(150, 480)
    assert np.all(np.isfinite([verdict.gain.share, verdict.gain.low, verdict.gain.high]))
    assert '"verdict": "named"' in verdict.to_json()
