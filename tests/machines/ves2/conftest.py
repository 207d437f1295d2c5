"""Runs that the comparison is tried on: healthy ones, and ones with something changed."""

from dataclasses import replace

import numpy as np
import pytest
from once import once

import ves_twin as vt
from ves_twin.effects.registry import build_effect

FAST = "ves2_pressure_fast"

CHANGES = {
    "plant": FAST,
    "run.duration": 8.0,
    "arm.moves": [{"start": 0.5, "duration": 3.0, "to": [0.8, 0.4, 0.3]}],
}
"""Eight seconds of the quick programme: every leg and joint moves. Legs without bodies suffice:
tests/cli/test_compare_command.py compares with them."""


@pytest.fixture(scope="session")
def scenario() -> vt.Scenario:
    return vt.Scenario.load("identify_fast", CHANGES)


@pytest.fixture(scope="session")
def healthy(scenario) -> vt.Recording:
    return once(vt.simulate, scenario, seed=3)


@pytest.fixture(scope="session")
def faulty(scenario):
    """A run of the rig with one effect: kind, target, sizes."""

    def run(kind: str, target: str, seed: int = 4, **sizes: float) -> vt.Recording:
        effect = build_effect(kind, target, sizes)
        plant = vt.Plant.load(FAST).extended(effect)
        return once(vt.simulate, scenario, plant, seed)

    return run


@pytest.fixture(scope="session")
def sticky(faulty) -> vt.Recording:
    return faulty("coulomb_friction", "leg.3", level=100.0)


@pytest.fixture(scope="session")
def changed():
    """A copy of a recording with one signal changed in place."""

    def change(recording: vt.Recording, name: str, edit) -> vt.Recording:
        values = recording[name].copy()
        edit(values)
        return replace(recording, signals={**recording.signals, name: values})

    return change


@pytest.fixture(scope="session")
def thinned():
    """A copy of a recording at another rate [Hz], each signal drawn straight."""

    def thin(recording: vt.Recording, rate: float) -> vt.Recording:
        time = np.arange(0.0, recording.time[-1], 1.0 / rate)
        signals = {
            name: np.column_stack([np.interp(time, recording.time, c) for c in values.T])
            for name, values in recording.signals.items()
        }
        return vt.Recording(time, signals, replace(recording.info, period=1.0 / rate))

    return thin
