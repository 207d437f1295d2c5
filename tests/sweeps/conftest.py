"""A small sweep that the tests share."""

from __future__ import annotations

import pytest

from ves_twin.sweeps.plan import SweepPlan, plan_sweep

SHORT = {"run.duration": 0.2, "run.settle": 0.2}
VARY = ["legs.gain=8,12.6", "effects.valve_null.leg.3.null=0,0.01"]


@pytest.fixture(scope="session")
def small_plan() -> SweepPlan:
    """Four short points of the beam scenario."""
    return plan_sweep("beam_horizontal_truth", VARY, SHORT)
