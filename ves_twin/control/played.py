"""Script: set-points and gravity estimates of an earlier run, played back cycle by cycle."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, final

import numpy as np

from ves_twin.control.gravity import GravityCompensation, GravityTask
from ves_twin.control.gravity_law import KNOWN_LAW
from ves_twin.control.readings import Readings
from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import Block, FloatArray
from ves_twin.mechanics.joint_motion import JointMotion, PlatformMotion

AHEAD = 3
"""Points beyond a record's end: the spline looks two ahead, from the last cycle on."""

FEWEST = 4
"""Commands below which a record has no curvature to go by."""


@final
@dataclass(frozen=True)
class PlayedPoses(PlatformMotion):
    """The pose of each cycle [m, rad] (n, 6); the first before it, the last after it."""

    poses: FloatArray
    period: float

    def pose(self, time: float) -> FloatArray:
        """Pose commanded at the cycle nearest to a time [s]."""
        return np.array(self.poses[_cycle(time, self.period, len(self.poses))])


@final
@dataclass(frozen=True)
class PlayedJoints(JointMotion):
    """The command point of the joint spline at each cycle [rad] (n, 3)."""

    points: FloatArray
    period: float

    def q(self, time: float) -> FloatArray:
        """Command point of the cycle nearest to a time [s]."""
        return np.array(self.points[_cycle(time, self.period, len(self.points))])


@final
@dataclass(frozen=True)
class PlayedWrench(GravityCompensation):
    """The gravity estimate of each cycle, sensor axes [N, N m] (n, 6)."""

    wrenches: FloatArray
    period: float
    law: ClassVar[Block] = KNOWN_LAW

    def wrench(self, time: float, readings: Readings) -> FloatArray:
        """Estimate of the cycle nearest to a time [s]."""
        return np.array(self.wrenches[_cycle(time, self.period, len(self.wrenches))])

    def snapshot(self) -> object:
        """Nothing changes from cycle to cycle."""
        return None

    def restore(self, snapshot: object) -> None:
        """Nothing to go back to."""


def learned_wrench(task: GravityTask) -> PlayedWrench:
    """The Learning Method at full speed: W_g(s), cycle by cycle, whatever the readings say.

    Raises:
        InvalidInputError: no W_g to play.

    Source: thesis 3.3.1, step 5.
    """
    if task.learned is None:
        raise InvalidInputError("gravity.file", None, "the W_g that method 'learned' plays")
    return PlayedWrench(task.learned.wrenches, task.learned.experiment.period)


@final
@dataclass(frozen=True)
class Script:
    """What the computers play back instead of deciding."""

    poses: PlayedPoses
    joints: PlayedJoints
    gravity: PlayedWrench


def spline_points(commands: FloatArray) -> FloatArray:
    """Points whose cubic B-spline passes through commands: the inverse of (1, 4, 1) / 6.

    Args:
        commands: values of the spline at the cycles (n, width).

    Returns:
        Control points (n + AHEAD, width); beyond either end the curvature stays, so that a record
        cut in a motion ends in it.
    """
    from scipy.linalg import solve_banded  # slow to import

    n = len(commands)
    if n < FEWEST:
        return np.concatenate([commands, np.repeat(commands[-1:], AHEAD, axis=0)])
    bands = np.zeros((5, n))
    bands[1, 1:], bands[2], bands[3, :-1] = 1.0, 4.0, 1.0
    # a parabola beyond the ends: p[-1] = 3 p[0] - 3 p[1] + p[2]
    bands[2, 0] = bands[2, -1] = 7.0
    bands[1, 1] = bands[3, n - 2] = -2.0
    bands[0, 2] = bands[4, n - 3] = 1.0
    points = list(solve_banded((2, 2), bands, 6.0 * commands))
    for _ in range(AHEAD):
        points.append(3.0 * points[-1] - 3.0 * points[-2] + points[-3])
    return np.array(points)


def _cycle(time: float, period: float, count: int) -> int:
    return min(max(round(time / period), 0), count - 1)
