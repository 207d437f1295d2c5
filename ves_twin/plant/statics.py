"""place_rig: put the compiled rig at a pose, legs closed and forces balanced."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np

from ves_twin.core.errors import UnreachableError
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.kinematics.rotations import matrix_from_angles, quaternion_from_angles
from ves_twin.mechanics.kinematics.stewart import StewartGeometry
from ves_twin.plant.layout import Layout
from ves_twin.plant.leg_part import leg_frame


def place_rig(
    data: mujoco.MjData,
    layout: Layout,
    geometry: StewartGeometry,
    pose: FloatArray,
    q: FloatArray,
    top: FloatArray | None = None,
) -> None:
    """Write the configuration of a pose: platform, straight legs, arm; velocities zero.

    Args:
        data: state that is written.
        layout: indices.
        geometry: joint positions that the legs were built for.
        pose: platform pose from home [m, rad] (6,).
        q: joint angles of the arm [rad] (3,).
        top: platform joints as they are [m] (6, 3), where an effect has moved them.
    """
    actual = geometry if top is None else replace(geometry, top=top)
    data.qvel[:] = 0.0
    at = layout.platform_qpos
    data.qpos[at : at + 3] = geometry.home + pose[:3]
    data.qpos[at + 3 : at + 7] = quaternion_from_angles(pose[3:])
    data.qpos[layout.arm_qpos] = q
    if layout.tendons:
        return
    data.qpos[layout.bending_qpos] = 0.0
    home = geometry.lengths(np.zeros(6))
    data.qpos[layout.slide_at] = actual.lengths(pose) - home
    data.qpos[layout.universal_qpos] = universal_angles(geometry, pose, actual.top).ravel()


def joints_on_platform(model: mujoco.MjModel) -> FloatArray:
    """Platform joints of a compiled rig in the top frame [m] (6, 3), effects included."""
    return np.array([model.site(f"platform/joint{i}").pos for i in range(1, 7)])


def universal_angles(
    geometry: StewartGeometry, pose: FloatArray, top: FloatArray | None = None
) -> FloatArray:
    """Angles of the universal joints (6, 2) [rad] that point each leg at its platform joint.

    Args:
        geometry: joint positions that the legs were built for.
        pose: platform pose from home [m, rad] (6,).
        top: platform joints as they are [m] (6, 3).
    """
    ends = geometry.top if top is None else top
    rotation = matrix_from_angles(np.asarray(pose[3:], dtype=float))
    angles = np.empty((6, 2))
    for i in range(6):
        leg = geometry.home + pose[:3] + rotation @ ends[i] - geometry.base[i]
        x, y, z = leg_frame(geometry, i).T @ leg / np.linalg.norm(leg)
        angles[i] = np.arctan2(-y, z), np.arcsin(x)
    return angles


def static_leg_forces(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    layout: Layout,
    geometry: StewartGeometry,
    pose: FloatArray,
) -> FloatArray:
    """Cylinder forces (6,) [N] that hold the platform and its payload at rest.

    Legs with bodies count as weightless; the rods' masses of the fast rig are the platform's.
    """
    mujoco.mj_forward(model, data)
    at = layout.platform_dof
    bias = data.qfrc_bias[at : at + 6].copy()
    rotation = matrix_from_angles(np.asarray(pose[3:], dtype=float))
    bias[3:] = rotation @ bias[3:]  # a free joint's moment is in body axes
    try:
        return np.asarray(np.linalg.solve(geometry.jacobian(pose).T, bias))
    except np.linalg.LinAlgError:
        raise UnreachableError(
            f"the legs cannot hold the platform at {np.round(pose, 4).tolist()}: singular geometry"
        ) from None


def check_reach(geometry: StewartGeometry, pose: FloatArray, travel: float, what: str) -> None:
    """Raise UnreachableError unless every leg stays within +-travel [m] of home at a pose (6,)."""
    change = geometry.lengths(np.asarray(pose, dtype=float)) - geometry.lengths(np.zeros(6))
    worst = int(np.argmax(np.abs(change)))
    if not abs(change[worst]) <= travel:
        raise UnreachableError(
            f"{what}: pose {np.round(pose, 4).tolist()} needs leg {worst + 1} at"
            f" {change[worst]:+.3f} m, travel is +-{travel:.3f} m"
        )
