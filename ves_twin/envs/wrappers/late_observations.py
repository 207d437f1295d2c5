"""LateObservations: observations that come some steps late."""

from __future__ import annotations

from collections import deque
from typing import Any, final

import gymnasium as gym
from gymnasium.utils import RecordConstructorArgs

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray


@final
class LateObservations(
    gym.Wrapper[FloatArray, FloatArray, FloatArray, FloatArray], RecordConstructorArgs
):
    """Every observation comes some steps late; before that the first one is shown.

    Args:
        env: any environment with vectors as observations.
        steps: by how many steps.
    """

    def __init__(self, env: gym.Env[FloatArray, FloatArray], steps: int) -> None:
        RecordConstructorArgs.__init__(self, steps=steps)
        super().__init__(env)
        if steps < 0:
            raise InvalidInputError("steps", steps, "0 or more")
        self._waiting: deque[FloatArray] = deque(maxlen=steps + 1)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[FloatArray, dict[str, Any]]:
        """Begin with the first observation on all places."""
        observation, info = self.env.reset(seed=seed, options=options)
        self._waiting.clear()
        for _ in range(self._waiting.maxlen or 1):
            self._waiting.append(observation)
        return self._waiting[0].copy(), info

    def step(self, action: FloatArray) -> tuple[FloatArray, Any, bool, bool, dict[str, Any]]:
        """The observation of some steps ago; reward, end and info are those of now."""
        observation, reward, terminated, truncated, info = self.env.step(action)
        self._waiting.append(observation)
        return self._waiting[0].copy(), reward, terminated, truncated, info
