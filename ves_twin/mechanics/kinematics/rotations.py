"""Rotations: fixed-axis X-Y-Z angles, quaternions (w, x, y, z) and the rate matrix between them."""

from __future__ import annotations

import numpy as np

from ves_twin.core.compiled import compiled
from ves_twin.core.types import FloatArray


@compiled
def matrix_from_angles(angles: FloatArray) -> FloatArray:
    """Rotation platform to inertial from fixed-axis X-Y-Z angles: R = Rz Ry Rx.

    Args:
        angles: phiX, phiY, phiZ [rad] (3,).

    Returns:
        R (3, 3).

    Source: thesis 2.3, errata E-1.
    """
    cx, sx = np.cos(angles[0]), np.sin(angles[0])
    cy, sy = np.cos(angles[1]), np.sin(angles[1])
    cz, sz = np.cos(angles[2]), np.sin(angles[2])
    r = np.empty((3, 3))
    r[0, 0], r[0, 1], r[0, 2] = cz * cy, cz * sy * sx - sz * cx, cz * sy * cx + sz * sx
    r[1, 0], r[1, 1], r[1, 2] = sz * cy, sz * sy * sx + cz * cx, sz * sy * cx - cz * sx
    r[2, 0], r[2, 1], r[2, 2] = -sy, cy * sx, cy * cx
    return r


@compiled
def angles_from_matrix(r: FloatArray) -> FloatArray:
    """Fixed-axis X-Y-Z angles [rad] (3,) of a rotation matrix (3, 3), |phiY| < 90 deg."""
    angles = np.empty(3)
    angles[0] = np.arctan2(r[2, 1], r[2, 2])
    angles[1] = np.arctan2(-r[2, 0], np.hypot(r[2, 1], r[2, 2]))
    angles[2] = np.arctan2(r[1, 0], r[0, 0])
    return angles


@compiled
def matrix_from_quaternion(q: FloatArray) -> FloatArray:
    """Rotation matrix (3, 3) of a unit quaternion w, x, y, z (4,)."""
    w, x, y, z = q[0], q[1], q[2], q[3]
    r = np.empty((3, 3))
    r[0, 0], r[0, 1], r[0, 2] = 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)
    r[1, 0], r[1, 1], r[1, 2] = 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)
    r[2, 0], r[2, 1], r[2, 2] = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)
    return r


@compiled
def quaternion_from_angles(angles: FloatArray) -> FloatArray:
    """Unit quaternion w, x, y, z (4,) of fixed-axis X-Y-Z angles [rad] (3,)."""
    cx, sx = np.cos(angles[0] / 2), np.sin(angles[0] / 2)
    cy, sy = np.cos(angles[1] / 2), np.sin(angles[1] / 2)
    cz, sz = np.cos(angles[2] / 2), np.sin(angles[2] / 2)
    q = np.empty(4)
    q[0] = cz * cy * cx + sz * sy * sx
    q[1] = cz * cy * sx - sz * sy * cx
    q[2] = cz * sy * cx + sz * cy * sx
    q[3] = sz * cy * cx - cz * sy * sx
    return q


@compiled
def rate_matrix(angles: FloatArray) -> FloatArray:
    """Matrix E with angular velocity (inertial axes) = E @ rates of the fixed-axis angles.

    Args:
        angles: phiX, phiY, phiZ [rad] (3,).

    Returns:
        E (3, 3); the identity at zero angles, singular at phiY = 90 deg.
    """
    cy, sy = np.cos(angles[1]), np.sin(angles[1])
    cz, sz = np.cos(angles[2]), np.sin(angles[2])
    e = np.zeros((3, 3))
    e[0, 0], e[1, 0], e[2, 0] = cz * cy, sz * cy, -sy
    e[0, 1], e[1, 1] = -sz, cz
    e[2, 2] = 1.0
    return e
