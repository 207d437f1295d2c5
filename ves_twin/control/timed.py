"""TimedPoses and TimedJoints: commands through rows of a file, straight between them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from ves_twin.control.played import AHEAD, spline_points
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.joint_motion import JointMotion, PlatformMotion


@final
@dataclass(frozen=True)
class TimedPoses(PlatformMotion):
    """Poses [m, rad] (n, 6) at times [s] (n,); the first before them, the last after them."""

    times: FloatArray
    poses: FloatArray

    def pose(self, time: float) -> FloatArray:
        """Pose at a time [s]."""
        return _at(time, self.times, self.poses)


@final
@dataclass(frozen=True)
class TimedJoints(JointMotion):
    """Command points [rad] (n, 3) of the joint spline at times [s] (n,)."""

    times: FloatArray
    points: FloatArray

    @staticmethod
    def through(times: FloatArray, commands: FloatArray) -> TimedJoints:
        """The points whose spline passes through commands [rad] (n, 3) at even times [s] (n,)."""
        step = (times[-1] - times[0]) / (len(times) - 1)
        beyond = times[-1] + step * np.arange(1, AHEAD + 1)
        return TimedJoints(np.concatenate([times, beyond]), spline_points(commands))

    def q(self, time: float) -> FloatArray:
        """Command point at a time [s]."""
        return _at(time, self.times, self.points)


def _at(time: float, times: FloatArray, rows: FloatArray) -> FloatArray:
    last = len(times) - 2
    k = min(max(int(np.searchsorted(times, time, "right")) - 1, 0), last)
    share = min(max((time - times[k]) / (times[k + 1] - times[k]), 0.0), 1.0)
    return np.asarray((1.0 - share) * rows[k] + share * rows[k + 1])
