"""Waypoints: quintic moves of the platform from pose to pose."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

from ves_twin.core.types import FloatArray
from ves_twin.mechanics.joint_motion import PlatformMotion, quintic


@dataclass(frozen=True)
class Waypoint:
    """One move: quintic from where the platform is to `to` [m, rad] (6,)."""

    start: float
    duration: float
    to: FloatArray


@final
@dataclass(frozen=True)
class Waypoints(PlatformMotion):
    """Moves one after the other, at rest at both ends of each.

    Attributes:
        at: pose before the first move [m, rad] (6,).
        moves: in the order of time, not overlapping.
    """

    at: FloatArray
    moves: tuple[Waypoint, ...]

    def pose(self, time: float) -> FloatArray:
        """Pose at a time [s]."""
        pose = self.at
        for move in self.moves:
            if time <= move.start:
                break
            pose = pose + quintic((time - move.start) / move.duration) * (move.to - pose)
        return pose
