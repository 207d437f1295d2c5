"""true_state: pose and joint angles of a rig at this instant, for rewards and analysis."""

from __future__ import annotations

import numpy as np

from ves_twin.core.compiled import compiled
from ves_twin.core.types import FloatArray, IntArray
from ves_twin.mechanics.kinematics.rotations import angles_from_matrix, matrix_from_quaternion
from ves_twin.simulator.rig import Rig

Place = tuple[FloatArray, int, IntArray, FloatArray]
"""Live qpos of a rig, first index of the platform, indices of the joints, origin at home [m]."""


def true_state(rig: Rig) -> tuple[FloatArray, FloatArray]:
    """Pose from home [m, rad] (6,) and joint angles [rad] (3,), as `truth.pose`, `truth.arm_q`."""
    pose, q = np.empty(6), np.empty(3)
    read_state(*state_place(rig), pose, q)
    return pose, q


def state_place(rig: Rig) -> Place:
    """Where `read_state` finds the state of a rig, for as long as the rig lives."""
    layout, home = rig.layout, rig.parameters["home"]["position"][0]
    return rig.data.qpos, layout.platform_qpos, layout.arm_qpos, home


@compiled
def read_state(
    qpos: FloatArray, platform: int, arm: IntArray, home: FloatArray, pose: FloatArray,
    q: FloatArray,
) -> None:  # fmt: skip
    """Write the state of a `Place` into pose [m, rad] (6,) and joint angles [rad] (3,)."""
    angles = angles_from_matrix(matrix_from_quaternion(qpos[platform + 3 : platform + 7]))
    for i in range(3):
        pose[i] = qpos[platform + i] - home[i]
        pose[3 + i] = angles[i]
        q[i] = qpos[arm[i]]
