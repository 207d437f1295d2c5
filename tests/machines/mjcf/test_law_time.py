"""A search for a law that nobody asked for, and that takes too long, is told as left out."""

from __future__ import annotations

import pytest
from pendulum import FED, MACHINE

from ves_twin.diagnosis.law import explained
from ves_twin.diagnosis.law.result import LAW
from ves_twin.diagnosis.record.runs import Runs
from ves_twin.diagnosis.settings import Settings
from ves_twin.machines.mjcf.motion.forward import MjcfForward


@pytest.mark.parametrize(
    ("laws", "longest", "looks", "told"),
    [
        (None, 300.0, True, False),
        (None, 0.0, False, True),
        (True, 0.0, True, False),
        (False, 0.0, False, False),
    ],
)
def test_a_law_that_takes_too_long_is_told_where_nobody_decided(
    monkeypatch, laws, longest, looks, told
):
    monkeypatch.setattr(explained, "LONGEST", longest)
    runs = Runs(MjcfForward.of(MACHINE), (FED,), (0, 1))
    assert explained._asked(runs, runs.origin, Settings(laws=laws)) is looks
    assert any(what.startswith(LAW) for what in runs.budget.left_out) is told
