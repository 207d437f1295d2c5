"""PathMotion: the arm follows a polyline of joint angles, at rest only at its ends."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.mechanics.joint_motion import JointMotion, quintic


@final
@dataclass(frozen=True)
class PathMotion(JointMotion):
    """One quintic in the length along a path, s(t) = L quintic((t - start) / duration).

    Moves of `ArmMotion` stop at every place; this one passes through. Where the path has a
    corner the joint rates jump, so a planned path comes rounded.

    Attributes:
        corners: joint angles along the way (k, 3) [rad].
        start: time at which the motion begins [s].
        duration: of the whole path [s].
    """

    corners: FloatArray
    start: float
    duration: float

    def q(self, time: float) -> FloatArray:
        """Joint angles [rad] (3,) at a time [s]."""
        lengths = path_lengths(self.corners)
        place = quintic((time - self.start) / self.duration) * lengths[-1]
        return at_lengths(self.corners, lengths, place)


def path_lengths(corners: FloatArray) -> FloatArray:
    """Length along a polyline (k, n) at each corner [rad] (k,)."""
    steps = np.linalg.norm(np.diff(corners, axis=0), axis=1)
    return np.concatenate([[0.0], np.cumsum(steps)])


def at_lengths(corners: FloatArray, lengths: FloatArray, places: FloatArray | float) -> FloatArray:
    """Points (..., n) of a polyline (k, n) with `path_lengths` (k,) at places along it (...)."""
    columns = [np.interp(places, lengths, column) for column in corners.T]
    return np.stack(columns, axis=-1)
