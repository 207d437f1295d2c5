"""The rig ves2, compiled once, and random poses that it reaches."""

from dataclasses import dataclass

import mujoco
import numpy as np
import pytest

from ves_twin.plant.assembly import assemble
from ves_twin.plant.layout import Layout
from ves_twin.plant.plant import Plant
from ves_twin.plant.statics import place_rig

TICK = 341e-6


@dataclass(frozen=True)
class Rig:
    plant: Plant
    model: mujoco.MjModel
    data: mujoco.MjData
    layout: Layout

    def place(self, pose: np.ndarray, q: np.ndarray) -> None:
        place_rig(self.data, self.layout, self.plant.geometry, pose, q)


@pytest.fixture(scope="session")
def plant() -> Plant:
    return Plant.load("ves2")


@pytest.fixture(scope="session")
def rig(plant) -> Rig:
    model = assemble(plant, TICK).compile()
    return Rig(plant, model, mujoco.MjData(model), Layout.of(model))


@pytest.fixture(scope="session")
def placements(plant) -> list[tuple[np.ndarray, np.ndarray]]:
    """50 random pairs of a tilted platform pose within the stroke and joint angles."""
    rng = np.random.default_rng(5)
    geometry, found = plant.geometry, []
    home = geometry.lengths(np.zeros(6))
    while len(found) < 50:
        pose = rng.uniform(-1, 1, 6) * [0.25, 0.25, 0.25, 0.35, 0.35, 0.5]
        if np.max(np.abs(geometry.lengths(pose) - home)) <= 0.25:
            found.append((pose, rng.uniform(-np.pi, np.pi, 3)))
    return found
