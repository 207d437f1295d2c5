"""StraightPath: the straight way in joint space, what a controller does if nobody plans."""

from __future__ import annotations

from typing import final

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.envs.baselines.path_policy import DURATION, PathPolicy, timed


@final
class StraightPath(PathPolicy):
    """One quintic of DURATION seconds on the line from start to goal."""

    def plan(self, start: FloatArray, goal: FloatArray) -> FloatArray:
        """Joint angles by step [rad] (n, 3)."""
        known = self._briefing
        return timed(np.array([start, goal]), DURATION, known.step, known.duration)
