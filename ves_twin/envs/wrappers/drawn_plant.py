"""DrawnPlant: a wrapper that gives each episode a plant of its own."""

from __future__ import annotations

import abc
from collections.abc import Mapping
from typing import Any, ClassVar

import gymnasium as gym
import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.envs.rig_env import rig_env
from ves_twin.plant.plant import Plant


class DrawnPlant(gym.Wrapper[FloatArray, FloatArray, FloatArray, FloatArray], abc.ABC):
    """Draws from a stream of the seed of its own; a plant in the options is changed in its turn.

    Args:
        env: an environment of this room.
    """

    STREAM: ClassVar[int]
    """Number of the stream."""

    def __init__(self, env: gym.Env[FloatArray, FloatArray]) -> None:
        super().__init__(env)
        self._inner = rig_env(env)
        self._rng = np.random.default_rng()

    @abc.abstractmethod
    def draw(self, plant: Plant, rng: np.random.Generator) -> Plant:
        """The plant of an episode."""

    def reset(
        self, *, seed: int | None = None, options: Mapping[str, Any] | None = None
    ) -> tuple[FloatArray, dict[str, Any]]:
        """Draw a plant, then begin."""
        if seed is not None:
            self._rng = np.random.default_rng([seed, self.STREAM])
        given = dict(options or {})
        given["plant"] = self.draw(self._inner.plant_of(given), self._rng)
        return self.env.reset(seed=seed, options=given)
