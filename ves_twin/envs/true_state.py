"""true_state: pose and joint angles of a rig at this instant, for rewards and analysis."""

from __future__ import annotations

import numpy as np

from ves_twin.compiled import compiled
from ves_twin.kinematics.rotations import angles_from_matrix, matrix_from_quaternion
from ves_twin.simulator.rig import Rig
from ves_twin.types import FloatArray, IntArray


def true_state(rig: Rig) -> tuple[FloatArray, FloatArray]:
    """Pose from home [m, rad] (6,) and joint angles [rad] (3,), as `truth.pose`, `truth.arm_q`."""
    layout, home = rig.layout, rig.parameters["home"]["position"][0]
    return _true_state(rig.data.qpos, layout.platform_qpos, layout.arm_qpos, home)


@compiled
def _true_state(
    qpos: FloatArray, platform: int, arm: IntArray, home: FloatArray
) -> tuple[FloatArray, FloatArray]:
    pose, q = np.empty(6), np.empty(3)
    angles = angles_from_matrix(matrix_from_quaternion(qpos[platform + 3 : platform + 7]))
    for i in range(3):
        pose[i] = qpos[platform + i] - home[i]
        pose[3 + i] = angles[i]
        q[i] = qpos[arm[i]]
    return pose, q
