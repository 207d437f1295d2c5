"""CommandedArm: joint set-points that an environment's actions make, as rates of the joints."""

from __future__ import annotations

from typing import final

import numpy as np

from ves_twin.control.motion import JointMotion
from ves_twin.types import FloatArray


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
        self._from, self._rate, self._next = self._start, np.zeros(3), np.zeros(3)

    def command(self, rate: FloatArray, begin: float, span: float) -> None:
        """Rates to reach at the end of a step.

        Args:
            rate: joint rates [rad/s] (3,).
            begin: when the step's set-points begin [s].
            span: length of the step [s].
        """
        place = self.q(begin)
        held = ((place <= self._low) & (self._next < 0)) | (
            (place >= self._high) & (self._next > 0)
        )
        self._from, self._rate = place, np.where(held, 0.0, self._next)
        reach = self._acceleration * span
        self._next = self._rate + np.clip(rate - self._rate, -reach, reach)
        self._begin, self._span = begin, span

    def q(self, time: float) -> FloatArray:
        """Joint angles [rad] (3,) at a time [s]."""
        s = min(max(time - self._begin, 0.0), self._span)
        bend = (self._next - self._rate) * (s * s / (2.0 * self._span))
        return np.clip(self._from + self._rate * s + bend, self._low, self._high)
