"""leg_part: one leg's MJCF with its numbers, and the orientation of its frame at home."""

from __future__ import annotations

import mujoco
import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.mechanics.kinematics.stewart import StewartGeometry
from ves_twin.plant.parameters import ParameterTable


def leg_frame(geometry: StewartGeometry, leg: int) -> FloatArray:
    """Axes of a leg at home as columns (3, 3): z to the platform joint, x in the vertical plane."""
    along = geometry.home + geometry.top[leg] - geometry.base[leg]
    z = along / np.linalg.norm(along)
    up = np.array([0.0, 0.0, 1.0])
    x = up - z * (up @ z)
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(z, x), z])


def leg_part(
    spec: mujoco.MjSpec, parameters: ParameterTable, geometry: StewartGeometry, leg: int
) -> tuple[mujoco.MjSpec, FloatArray]:
    """Write the numbers of one leg into its part.

    The cylinder is a slender rod about its middle, the rod likewise; a sideways offset of the
    bending hinge couples bending to the leg's axis.

    Args:
        spec: the part leg.xml.
        parameters: numbers of the rig.
        geometry: joint positions.
        leg: index of the leg, 0 to 5.

    Returns:
        The part, and the quaternion (4,) of its frame in the inertial frame.
    """
    number = parameters.number
    length = float(geometry.lengths(np.zeros(6))[leg])
    hinge = number("leg.cylinder_length")
    cylinder, rod = spec.body("cylinder"), spec.body("rod")
    _slender(cylinder, number("leg.cylinder_mass"), hinge, number("leg.cylinder_radius"), hinge / 2)
    rod_length = number("leg.rod_length")
    middle = length - hinge - rod_length / 2
    _slender(rod, number("leg.rod_mass"), rod_length, number("leg.rod_radius"), middle)
    rod.pos = [0.0, 0.0, hinge]
    for name in ("universal_x", "universal_y"):
        spec.joint(name).damping = np.array([number("leg.joint_damping"), 0.0, 0.0])
    for name in ("bending_x", "bending_y"):
        joint = spec.joint(name)
        joint.pos = [number("leg.bending_offset"), 0.0, 0.0]
        joint.stiffness = np.array([number("leg.bending_stiffness"), 0.0, 0.0])
        joint.damping = np.array([number("leg.bending_damping"), 0.0, 0.0])
    spec.site("rod_end").pos = [0.0, 0.0, length - hinge]
    quaternion = np.zeros(4)
    mujoco.mju_mat2Quat(quaternion, leg_frame(geometry, leg).ravel())
    return spec, quaternion


def _slender(
    body: mujoco.MjsBody, mass: float, length: float, radius: float, middle: float
) -> None:
    across = mass * length**2 / 12.0
    body.mass = mass
    body.ipos = [0.0, 0.0, middle]
    body.inertia = [across, across, mass * radius**2 / 2.0]
