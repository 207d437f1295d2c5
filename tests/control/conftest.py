"""What controllers are told: a belief, a task, readings that cannot be written to."""

import dataclasses

import numpy as np
import pytest

from ves_twin.control.belief import Belief
from ves_twin.control.controller import ControlTask
from ves_twin.control.readings import Readings
from ves_twin.mechanics.emulated import EmulatedSystem
from ves_twin.mechanics.joint_motion import Sine
from ves_twin.plant.plant import Plant

PERIOD = 1.0 / 80.0


def frozen(values) -> np.ndarray:
    array = np.array(values, dtype=float)
    array.setflags(write=False)
    return array


@pytest.fixture(scope="session")
def belief() -> Belief:
    plant = Plant.load("ves2")
    position = plant.parameters.array("sensor.position")
    return Belief(
        plant.geometry,
        plant.arm,
        frozen(position),
        leg_travel=0.242,
        full_speed=0.5,
        gravity=plant.gravity_model,
    )


@pytest.fixture
def task(belief) -> ControlTask:
    """A task that has what any controller may ask for, all arrays read-only."""
    motion = Sine(
        at=frozen([0.0, 0.0, 0.05, 0.0, 0.0, 0.0]),
        amplitude=frozen([0.05, 0.04, 0.03, 0.1, 0.05, 0.1]),
        frequency=frozen([0.3, 0.4, 0.5, 0.35, 0.45, 0.25]),
        phase=frozen(np.zeros(6)),
        fade=1.0,
    )
    return ControlTask(
        belief=belief,
        period=PERIOD,
        start=frozen([0.02, -0.02, 0.01, 0.05, -0.05, 0.1]),
        home=frozen(np.zeros(6)),
        emulated=EmulatedSystem.load("beam_horizontal_thesis"),
        motion=motion,
        subtract_gravity=True,
    )


@pytest.fixture
def readings():
    """Readings by keyword; the rest are zeros; arrays are read-only."""

    def build(**fields) -> Readings:
        widths = {"arm_q": 3, "supply_pressure": 1}
        names = [field.name for field in dataclasses.fields(Readings)]
        return Readings(
            **{name: frozen(fields.get(name, np.zeros(widths.get(name, 6)))) for name in names}
        )

    return build
