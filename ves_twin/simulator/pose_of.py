"""read_pose: the true pose of the platform, in compiled code."""

from __future__ import annotations

from ves_twin.core.compiled import compiled
from ves_twin.core.types import FloatArray, Record
from ves_twin.mechanics.kinematics.rotations import angles_from_matrix, matrix_from_quaternion


@compiled
def read_pose(p: Record, qpos: FloatArray, pose: FloatArray) -> None:
    """Write the true pose of the platform from home [m, rad] (6,)."""
    at = p.layout.platform_qpos
    angles = angles_from_matrix(matrix_from_quaternion(qpos[at + 3 : at + 7]))
    for i in range(3):
        pose[i] = qpos[at + i] - p.home.position[i]
        pose[3 + i] = angles[i]
