"""RandomRigs: a rig of a set for every episode."""

from __future__ import annotations

from typing import ClassVar, final

import gymnasium as gym
import numpy as np
from gymnasium.utils import RecordConstructorArgs

from ves_twin.core.types import FloatArray
from ves_twin.envs.rig_set import RigSet
from ves_twin.envs.wrappers.drawn_plant import DrawnPlant
from ves_twin.plant.plant import Plant


@final
class RandomRigs(DrawnPlant, RecordConstructorArgs):
    """A rig of a set (`RigSet`) for every episode; the computers keep their belief.

    Args:
        env: an environment of this room.
        rigs: name or file of a set, for instance "train-v0".
    """

    STREAM: ClassVar[int] = 1

    def __init__(self, env: gym.Env[FloatArray, FloatArray], rigs: str) -> None:
        RecordConstructorArgs.__init__(self, rigs=rigs)
        super().__init__(env)
        self._set = RigSet.load(rigs)

    def draw(self, plant: Plant, rng: np.random.Generator) -> Plant:
        """A rig of the set."""
        return self._set.draw(plant, rng)
