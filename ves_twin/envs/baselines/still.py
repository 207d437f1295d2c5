"""Still: does nothing; what happens to a rig that nobody controls."""

from __future__ import annotations

from typing import final

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.envs.policy import Policy, TaskSpec


@final
class Still(Policy):
    """Zero actions: the arm holds its angles, the platform stays in position control."""

    def __init__(self, width: int) -> None:
        self._width = width

    @classmethod
    def build(cls, briefing: TaskSpec) -> Still:
        """For any environment."""
        return cls(briefing.actions.width)

    def begin(self, observation: FloatArray) -> None:
        """Nothing to forget."""

    def act(self, observation: FloatArray) -> FloatArray:
        """Zeros."""
        return np.zeros(self._width)
