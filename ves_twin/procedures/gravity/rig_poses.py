"""RigPoses: which poses of platform and arm an experiment visits, as a table of its file."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from pydantic import Field

from ves_twin.control.belief import Belief
from ves_twin.core.errors import UnreachableError
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.gravity.poses import Choice, PoseRange, choose_poses
from ves_twin.plant.statics import check_reach
from ves_twin.scenario.fields import Joints, Metres, Part, named, si

Radians = Annotated[float, si("rad"), Field(ge=0, le=0.6)]


class RigPoses(Part):
    """Poses at home position, tilted and turned, with the arm anywhere in its range.

    `clearance` is how high elbow and forearm stay above the top plate: the thesis gives no limits,
    assumed.
    """

    count: Annotated[int, Field(ge=1, le=2000)] = 47
    choice: Annotated[Choice, named("choice of poses", [c.value for c in Choice])] = (
        Choice.D_OPTIMAL
    )
    tilt: Radians = 0.17453292519943295
    turn: Radians = 0.17453292519943295
    joint_low: Joints = (-2.8, -0.7, -2.5)
    joint_high: Joints = (2.8, 3.8, 2.5)
    clearance: Metres = 0.3

    def choose(
        self, belief: Belief, full_scale: FloatArray, seed: int
    ) -> tuple[FloatArray, FloatArray]:
        """Platform poses (n, 6) and joint angles (n, 3).

        Raises:
            InvalidInputError: hardly any pose in this range can be reached.
        """
        limits = PoseRange(
            np.array(self.joint_low),
            np.array(self.joint_high),
            self.tilt,
            self.turn,
            lambda q, angles: self._reachable(belief, q, angles),
        )
        q, angles = choose_poses(
            self.choice,
            self.count,
            limits,
            belief.gravity,
            belief.sensor_position,
            full_scale,
            seed,
        )
        return np.column_stack([np.zeros((len(q), 3)), angles]), q

    def _reachable(self, belief: Belief, q: FloatArray, angles: FloatArray) -> bool:
        heights = belief.arm.transforms(q)[1:, 2, 3]
        if np.min(heights) < self.clearance:
            return False
        try:
            check_reach(
                belief.geometry, np.concatenate([np.zeros(3), angles]), belief.leg_travel, ""
            )
        except UnreachableError:
            return False
        return True
