"""TaskEnv: what all environments of this room share: tables, spaces, what an action must be."""

from __future__ import annotations

import abc
import math
from collections.abc import Mapping
from typing import Any

import gymnasium as gym
import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray, SingleArray
from ves_twin.envs.channels import Channels

Observation = FloatArray | SingleArray


class TaskEnv(gym.Env[Any, FloatArray], abc.ABC):
    """Actions are shares of a scale, -1 to 1; observations are what was measured, never truth.

    A finite action beyond the scale is clipped and `info` says so; one that is not finite, or of
    another shape, is refused before anything moves.

    Attributes:
        observations: the table of the observation's columns.
        actions: the table of the action's columns; bounds are the scale.
        reading: the last observation in the units of `observations` (m,), scaled or not.

    Args:
        observations: the one table.
        actions: the other.
        scaled: observations as shares of their bounds, -1 to 1, in single precision like the
            actions; what networks take. In physical units and double precision otherwise.
    """

    reading: FloatArray

    def __init__(self, observations: Channels, actions: Channels, scaled: bool) -> None:
        self.observations, self.actions = observations, actions
        self._scaled = scaled
        self.observation_space = (
            _shares(observations.width, np.float32)
            if scaled
            else gym.spaces.Box(observations.low, observations.high, dtype=np.float64)
        )
        self.action_space = _shares(actions.width, np.float32 if scaled else np.float64)

    @abc.abstractmethod
    def briefing(self) -> Any:
        """What a policy may know before it begins; nothing in it tells the truth."""

    @property
    @abc.abstractmethod
    def faults(self) -> list[dict[str, Any]]:
        """What is wrong in the present episode: kind, target and sizes; for analysis alone."""

    def physical(self, action: FloatArray) -> tuple[FloatArray, bool]:
        """An action in the units of `actions` (n,), and whether it was clipped.

        Raises:
            InvalidInputError: another shape, or not finite.
        """
        given = np.asarray(action, float)
        shares = given.tolist()
        if given.shape != self.action_space.shape or not all(map(math.isfinite, shares)):
            what = f"{self.actions.width} finite numbers from -1 to 1"
            raise InvalidInputError("action", np.asarray(action).tolist(), what)
        inside = [min(max(share, -1.0), 1.0) for share in shares]
        if inside == shares:
            return given * self.actions.high, False
        return np.array(inside) * self.actions.high, True

    def observed(self, values: Mapping[str, FloatArray]) -> Observation:
        """Values by name as an observation."""
        self.reading = self.observations.vector(values)
        return self.observations.shares(self.reading) if self._scaled else self.reading.copy()


def _shares(width: int, dtype: type[np.float32 | np.float64]) -> Any:
    return gym.spaces.Box(-1.0, 1.0, (width,), dtype)


def task_env(env: gym.Env[Any, Any]) -> TaskEnv:
    """The environment of this room under any wrappers.

    Raises:
        InvalidInputError: an environment of another kind.
    """
    inner = env.unwrapped
    if not isinstance(inner, TaskEnv):
        raise InvalidInputError("environment", type(inner).__name__, "one of ves_twin.envs")
    return inner
