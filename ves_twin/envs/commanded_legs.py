"""CommandedLegs: leg set-points that an environment's actions make, beside a reference motion."""

from __future__ import annotations

from collections.abc import Sequence
from typing import final

import numpy as np

from ves_twin.control.controller import ControlTask, PlatformController
from ves_twin.control.platform_law import KNOWN_LAW
from ves_twin.control.readings import Readings
from ves_twin.core.compiled import compiled
from ves_twin.core.errors import UnreachableError
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.joint_motion import Hold, PlatformMotion
from ves_twin.mechanics.kinematics.stewart import StewartGeometry, leg_lengths, near_pose

SLEW = 0.1
"""Fastest change of an offset [m/s]: what the platform does anyway, so that jumps of an action do
not shake the payload out of the force sensor's range."""


@final
class CommandedLegs(PlatformController):
    """Sends the leg lengths of a reference pose plus offsets, which go linearly over a step.

    They go no faster than SLEW. With offsets of zero it is the position controller. Its pose is
    the one that the believed geometry has at the commanded lengths, so safety checks see what
    any other controller shows.

    Attributes:
        motion: the reference.
    """

    law = KNOWN_LAW

    def __init__(self, geometry: StewartGeometry, start: FloatArray) -> None:
        self._geometry = geometry
        self.motion: PlatformMotion = Hold(start)
        self.hold()

    @classmethod
    def build(cls, task: ControlTask) -> CommandedLegs:
        """Stand at the task's start pose until a motion is given."""
        return cls(task.belief.geometry, task.start)

    def hold(self) -> None:
        """No offsets, whatever was commanded before."""
        self._begin, self._span = 0.0, 1.0
        self._from, self._to = np.zeros(6), np.zeros(6)

    def command(self, offsets: FloatArray, begin: float, span: float) -> None:
        """Offsets [m] (6,) to reach at the end of a step that begins at a time [s]."""
        self._from = self._offsets(begin)
        self._begin, self._span = begin, span
        reach = SLEW * span
        self._to = self._from + np.minimum(np.maximum(offsets - self._from, -reach), reach)

    def update(self, time: float, readings: Readings) -> FloatArray:
        """The pose at which the legs have the commanded lengths [m, rad] (6,)."""
        return np.asarray(self.ahead((time,), readings)[0])

    def ahead(self, times: Sequence[float], readings: Readings) -> FloatArray:
        """The same at coming times [m, rad] (n, 6).

        Raises:
            UnreachableError: no pose near a reference has the lengths.
        """
        references = np.asarray(self.motion.along(times), float)
        offsets, g = np.array([self._offsets(time) for time in times]), self._geometry
        poses = _poses(references, offsets, g.base, g.top, g.home)
        if not np.all(np.isfinite(poses)):
            raise UnreachableError("no platform pose near the reference has the commanded lengths")
        return poses

    def _offsets(self, time: float) -> FloatArray:
        share = min(max((time - self._begin) / self._span, 0.0), 1.0)
        return np.asarray(self._from + share * (self._to - self._from))

    def snapshot(self) -> object:
        """Reference, offsets and their times."""
        return (self.motion, self._begin, self._span, self._from.copy(), self._to.copy())

    def restore(self, snapshot: object) -> None:
        """Go back to a snapshot."""
        self.motion, self._begin, self._span, self._from, self._to = snapshot  # type: ignore[misc]


@compiled
def _poses(
    references: FloatArray, offsets: FloatArray, base: FloatArray, top: FloatArray, home: FloatArray
) -> FloatArray:
    """Poses (n, 6) whose leg lengths are those of references and offsets; NaN where none is."""
    poses = references.copy()
    for k in range(len(references)):
        lengths = leg_lengths(references[k], base, top, home) + offsets[k]
        if not near_pose(lengths, poses[k], base, top, home):
            poses[k] = np.nan
    return poses
