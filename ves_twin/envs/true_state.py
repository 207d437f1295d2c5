"""true_state: pose and joint angles of a rig at this instant, for rewards and analysis."""

from __future__ import annotations

import numpy as np

from ves_twin.kinematics.rotations import angles_from_matrix, matrix_from_quaternion
from ves_twin.simulator.rig import Rig
from ves_twin.types import FloatArray


def true_state(rig: Rig) -> tuple[FloatArray, FloatArray]:
    """Pose from home [m, rad] (6,) and joint angles [rad] (3,), as `truth.pose`, `truth.arm_q`."""
    qpos, at = rig.data.qpos, rig.layout.platform_qpos
    pose = np.empty(6)
    pose[:3] = qpos[at : at + 3] - rig.plant.geometry.home
    pose[3:] = angles_from_matrix(matrix_from_quaternion(qpos[at + 3 : at + 7]))
    return pose, qpos[rig.layout.arm_qpos]
