"""Ramp: a quintic way of the platform from pose to pose, as slow as its fastest leg allows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ves_twin.core.read_only import ReadOnly
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.joint_motion import quintic
from ves_twin.mechanics.kinematics.stewart import StewartGeometry


@dataclass(frozen=True)
class Ramp(ReadOnly):
    """Way between two poses.

    Attributes:
        start: when it begins [s].
        duration: how long it takes [s].
        here: pose at its begin [m, rad] (6,).
        there: pose at its end (6,).
    """

    start: float
    duration: float
    here: FloatArray
    there: FloatArray

    @staticmethod
    def between(
        here: FloatArray, there: FloatArray, start: float, speed: float, geometry: StewartGeometry
    ) -> Ramp:
        """A ramp on which the leg that moves farthest has a mean speed [m/s]."""
        farthest = float(np.max(np.abs(geometry.lengths(there) - geometry.lengths(here))))
        return Ramp(start, farthest / speed, here.copy(), there.copy())

    def pose(self, time: float) -> FloatArray:
        """The pose at a time [s] (6,)."""
        if self.ended(time):
            return self.there.copy()
        share = quintic((time - self.start) / self.duration)
        return self.here + share * (self.there - self.here)

    def ended(self, time: float) -> bool:
        """Whether the way is over."""
        return time >= self.start + self.duration
