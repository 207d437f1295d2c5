"""shipped: scenarios as they are shipped, each run once for all tests of a session."""

from __future__ import annotations

from collections.abc import Iterable

import mujoco
import numpy as np
import pytest
from once import once

import ves_twin as vt
from ves_twin.simulator.outcome import Outcome
from ves_twin.simulator.simulate import recording_info

ALIKE = {
    "admittance_tuning", "beam_model_method", "gravity_compensation", "identify_slow",
    "microgravity_capture", "operation_session", "platform_tracking", "vibration_damping",
    "vibration_free_reach",
}  # fmt: skip
"""Of each another scenario does the like by day; run whole in `make nightly` alone."""

PIECE = 0.1
"""Time between two looks at the legs [s]; a run in pieces is the run at once, to the last bit."""


def each_scenario(names: Iterable[str]) -> pytest.MarkDecorator:
    """A test of each of some shipped scenarios, run whole."""
    marks = {name: [pytest.mark.slow, *[pytest.mark.nightly] * (name in ALIKE)] for name in names}
    return pytest.mark.parametrize("name", [pytest.param(n, marks=m) for n, m in marks.items()])


def full_run(name: str) -> tuple[vt.Recording, float]:
    """A scenario on the full rig: recording, largest gap seen between a rod and its joint [m]."""
    return once(_full_run, name)


def fast_run(name: str) -> vt.Recording:
    """A scenario on the rig without leg bodies."""
    return once(_fast_run, name)


def _full_run(name: str) -> tuple[vt.Recording, float]:
    scenario = vt.Scenario.load(name)
    sim = vt.Simulator(vt.Plant.load(scenario.plant).with_fidelity("full"), scenario)
    gap = 0.0
    while not sim.done:
        sim.advance(PIECE)
        if sim.outcome in (None, Outcome.COMPLETED):
            gap = max(gap, _gap(sim))
    time, signals = sim.recorder.collect()
    return vt.Recording(time, signals, recording_info(sim)), gap


def _gap(sim: vt.Simulator) -> float:
    seen = mujoco.MjData(sim.model)  # a copy: looking changes nothing
    seen.qpos[:] = sim.data.qpos
    mujoco.mj_kinematics(sim.model, seen)
    ends = [
        seen.site(f"leg{i}/rod_end").xpos - seen.site(f"platform/joint{i}").xpos
        for i in range(1, 7)
    ]
    return float(np.linalg.norm(ends, axis=1).max())


def _fast_run(name: str) -> vt.Recording:
    scenario = vt.Scenario.load(name)
    return vt.simulate(scenario, vt.Plant.load(scenario.plant).with_fidelity("fast"))


@pytest.fixture(scope="session")
def beam_minute() -> vt.Recording:
    """The beam scenario as shipped, 60 s."""
    return full_run("beam_horizontal_truth")[0]


@pytest.fixture(scope="session")
def beam_short() -> vt.Recording:
    """Three seconds of the beam scenario: the arm's move."""
    return once(vt.simulate, vt.Scenario.load("beam_horizontal_truth", {"run.duration": 3.0}))
