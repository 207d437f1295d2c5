"""Causes that belong to a stretch of time, judged on what comes after it."""

from dataclasses import replace

import numpy as np
import pytest
from toy import QUICK, Toy, programme, record

from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.diagnosis.diagnose import diagnose
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.diagnosis.unseen.forecast import _part
from ves_twin.diagnosis.verdict.verdict import Kind


class Passing(Toy):
    """Its drift belongs to the recorded stretch."""

    @property
    def hypotheses(self):
        return tuple(replace(h, transient=h.effect == "drift") for h in Toy.hypotheses.fget(self))


def dense(seconds):
    """Rows at 1 kHz."""
    fed, time = programme(), 0.001 * np.arange(int(1000 * seconds))
    u = np.interp(time, fed.time, fed.drive["drive.u"][:, 0])[:, None]
    return Excitation("dense", time, {"drive.u": u})


def test_a_part_too_short_on_the_grid_is_no_part():
    time = 0.001 * np.arange(3000)
    whole = Recording(time, {"out": np.zeros((3000, 2))}, RecordingInfo("measured"))
    assert not _part(whole, 2.1, np.inf, 100.0)  # 900 rows, 80 on the grid
    assert _part(whole, -np.inf, 2.1, 100.0)


@pytest.mark.parametrize(("seconds", "told"), [(3.0, False), (6.0, True)])
def test_a_short_recording_at_a_high_rate_has_no_forecast_and_a_verdict(seconds, told):
    fed = dense(seconds)
    data = record(np.random.default_rng(4), {"drift.size": 0.5}, fed=fed)
    found = diagnose(Passing(), [data], settings=replace(QUICK, simulated_nulls=False))
    assert (found.verdict, found.causes[0].effect) == (Kind.NAMED, "drift")
    assert (found.forecast is not None) is told
