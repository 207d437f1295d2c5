"""GravityFeedforward: joint torques that hold the arm's weight, from the belief's mass model."""

from __future__ import annotations

from typing import final

import numpy as np

from ves_twin.control.belief import Belief
from ves_twin.control.readings import Readings
from ves_twin.core.types import FloatArray


@final
class GravityFeedforward:
    """Once a cycle the torque that the believed weight needs at the measured joints and attitude.

    A soft joint servo without integrator would sag. With this it answers the motion of the base
    as it would without gravity, up to the cycle in which the torque is held.
    """

    def __init__(self, belief: Belief) -> None:
        self._geometry, self._model = belief.geometry, belief.gravity
        self._pose = np.zeros(6)

    def torque(self, readings: Readings) -> FloatArray:
        """Joint torques [N m] (3,)."""
        self._pose = self._geometry.pose(readings.leg_length, self._pose)
        q, angles = readings.arm_q[None, :], self._pose[None, 3:]
        return np.asarray(self._model.holding_torque(q, angles)[0])

    def snapshot(self) -> object:
        """The pose from which the next solution starts (6,)."""
        return self._pose.copy()

    def restore(self, snapshot: object) -> None:
        """Set the pose from which the next solution starts."""
        self._pose = np.array(snapshot, dtype=float)
