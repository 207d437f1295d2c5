"""HotSpotPath: the thesis's way, planned on the coupling map."""

from __future__ import annotations

from typing import final

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.envs.arm_env import HIGH, LOW
from ves_twin.envs.baselines.path_policy import DURATION, PathPolicy, timed
from ves_twin.mechanics.planning.hot_spot import hot_spot_path
from ves_twin.plant.puma_chain import puma_chain

CELLS = 16
"""Cells along each joint that moves; all three move here, so the grid is coarser than the map."""


@final
class HotSpotPath(PathPolicy):
    """Shortest way in the metric of the believed coupling, DURATION seconds. Source: thesis 4.2."""

    def plan(self, start: FloatArray, goal: FloatArray) -> FloatArray:
        """Joint angles by step [rad] (n, 3)."""
        known = self._briefing
        if known.emulated is None:
            raise InvalidInputError("HotSpotPath", "no emulated base", "one to plan on")
        low, high = np.minimum(LOW, start), np.maximum(HIGH, start)
        path = hot_spot_path(
            puma_chain(known.belief), known.emulated, start, goal, low, high, CELLS
        )
        return timed(path, DURATION, known.step, known.duration)
