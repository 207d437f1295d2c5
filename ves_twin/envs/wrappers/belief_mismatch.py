"""BeliefMismatch: a plant that departs from what the computers believe."""

from __future__ import annotations

from typing import ClassVar, final

import gymnasium as gym
import numpy as np
from gymnasium.utils import RecordConstructorArgs

from ves_twin.core.types import FloatArray
from ves_twin.envs.rig_set import commissioned
from ves_twin.envs.wrappers.drawn_plant import DrawnPlant
from ves_twin.plant.plant import NOMINAL, Plant


@final
class BeliefMismatch(DrawnPlant, RecordConstructorArgs):
    """A plant that departs from the belief by what commissioning leaves open.

    Args:
        env: an environment of this room.
        sigmas: parameter -> how many of its declared sd, for instance {"arm.mass": 1.0}.
    """

    STREAM: ClassVar[int] = 2

    def __init__(self, env: gym.Env[FloatArray, FloatArray], sigmas: dict[str, float]) -> None:
        RecordConstructorArgs.__init__(self, sigmas=sigmas)
        super().__init__(env)
        self._sigmas = dict(sigmas)
        self.draw(
            Plant.load(NOMINAL), self._rng
        )  # an unknown name is refused now, not at the first episode

    def draw(self, plant: Plant, rng: np.random.Generator) -> Plant:
        """The plant with drawn parameters."""
        return commissioned(plant, self._sigmas, rng)
