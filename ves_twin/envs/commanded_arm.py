"""CommandedArm: joint set-points that an environment's actions make, as rates of the joints."""

from __future__ import annotations

from collections.abc import Sequence
from typing import final

import numpy as np

from ves_twin.core.compiled import compiled
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.joint_motion import JointMotion


@final
class CommandedArm(JointMotion):
    """Set-points whose rate goes linearly from the last one to the one commanded, over a step.

    Within a step of length h, s seconds after its beginning and with rates r0 and r1,
    q = q0 + r0 s + (r1 - r0) s^2 / (2 h), held within the joints' bounds. The computers ask two
    cycles ahead (thesis 2.4.3), so a step's set-points begin one cycle after the command.

    Args:
        start: joint angles before the first command [rad] (3,).
        low: smallest set-point of each joint [rad] (3,).
        high: largest set-point [rad] (3,).
        acceleration: fastest change of a rate [rad/s^2]; a command beyond it is reached in part.
    """

    def __init__(
        self, start: FloatArray, low: FloatArray, high: FloatArray, acceleration: float
    ) -> None:
        self._start, self._low, self._high = (np.array(a, float) for a in (start, low, high))
        self._acceleration = acceleration
        self.hold()

    def hold(self) -> None:
        """Stand at the start angles, whatever was commanded before."""
        self._begin, self._span = np.inf, 1.0
        self._from, self._rate, self._next = self._start.copy(), np.zeros(3), np.zeros(3)

    def command(self, rate: FloatArray, begin: float, span: float) -> None:
        """Rates to reach at the end of a step.

        Args:
            rate: joint rates [rad/s] (3,).
            begin: when the step's set-points begin [s].
            span: length of the step [s].
        """
        self._from = self.q(begin)
        reach = self._acceleration * span
        _turn(self._from, self._rate, self._next, rate, self._low, self._high, reach)
        self._begin, self._span = begin, span

    def q(self, time: float) -> FloatArray:
        """Joint angles [rad] (3,) at a time [s]."""
        return np.asarray(self.along((time,))[0])

    def along(self, times: Sequence[float]) -> FloatArray:
        """Joint angles [rad] (n, 3) at several times [s]."""
        begin, span = self._begin, self._span
        q = np.array([min(max(time - begin, 0.0), span) for time in times])[:, None].repeat(3, 1)
        _places(self._from, self._rate, self._next, self._low, self._high, q, span)
        return q


@compiled
def _places(
    start: FloatArray, rate: FloatArray, following: FloatArray, low: FloatArray, high: FloatArray,
    q: FloatArray, span: float,
) -> None:  # fmt: skip
    """Put joint angles (n, 3) in the place of the seconds since the step began."""
    for k in range(len(q)):
        for j in range(3):
            s = q[k, j]
            bend = (following[j] - rate[j]) * s * s / (2.0 * span)
            q[k, j] = min(max(start[j] + rate[j] * s + bend, low[j]), high[j])


@compiled
def _turn(
    place: FloatArray, rate: FloatArray, following: FloatArray, wanted: FloatArray,
    low: FloatArray, high: FloatArray, reach: float,
) -> None:  # fmt: skip
    """Begin with the rate reached, none out of a bound; end as near the wanted one as can be."""
    for j in range(3):
        now = following[j]
        if (place[j] <= low[j] and now < 0.0) or (place[j] >= high[j] and now > 0.0):
            now = 0.0
        rate[j] = now
        following[j] = now + min(max(wanted[j] - now, -reach), reach)
