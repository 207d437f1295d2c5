"""DmFace: an environment of this room behind the interface of dm_env."""

from __future__ import annotations

from typing import Any, final

import dm_env
import gymnasium as gym
import numpy as np
from dm_env import specs

from ves_twin.core.types import FloatArray
from ves_twin.envs.rig_env import rig_env


@final
class DmFace(dm_env.Environment):  # type: ignore[misc]
    """Observations by name with their bounds; a safety stop has discount 0, the end of time 1.

    Args:
        env: an environment of this room, with any wrappers.
        seed: of the first episode; later ones go on from it.
    """

    def __init__(self, env: gym.Env[FloatArray, FloatArray], seed: int = 0) -> None:
        self._env, self._inner = env, rig_env(env)
        self._seed: int | None = seed
        self._over = True
        self.info: dict[str, Any] = {}

    def reset(self) -> dm_env.TimeStep:
        """Begin an episode."""
        observation, self.info = self._env.reset(seed=self._seed)
        self._seed, self._over = None, False
        return dm_env.restart(self._named(observation))

    def step(self, action: FloatArray) -> dm_env.TimeStep:
        """Step; begins an episode where the last one is over."""
        if self._over:
            return self.reset()
        observation, reward, terminated, truncated, self.info = self._env.step(action)
        named, gain = self._named(observation), float(reward)
        self._over = terminated or truncated
        if terminated:
            return dm_env.termination(gain, named)
        if truncated:
            return dm_env.truncation(gain, named)
        return dm_env.transition(gain, named)

    def observation_spec(self) -> dict[str, specs.BoundedArray]:
        """Bounds of each channel in its unit."""
        return {
            c.name: specs.BoundedArray((c.width,), np.float64, c.low, c.high, c.name)
            for c in self._inner.observations.channels
        }

    def action_spec(self) -> specs.BoundedArray:
        """Shares from -1 to 1."""
        return specs.BoundedArray((self._inner.actions.width,), np.float64, -1.0, 1.0, "action")

    def close(self) -> None:
        """Close the environment."""
        self._env.close()

    def _named(self, observation: FloatArray) -> dict[str, FloatArray]:
        return self._inner.observations.split(observation)
