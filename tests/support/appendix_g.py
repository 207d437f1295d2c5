"""appendix_g_mass_matrix: the PUMA's mass matrix in the closed form of thesis Appendix G."""

from __future__ import annotations

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.mechanics.kinematics.puma560 import Puma560
from ves_twin.mechanics.planning.chain import skew


def appendix_g_mass_matrix(
    arm: Puma560,
    mass: FloatArray,
    com: FloatArray,
    inertia: FloatArray,
    q: FloatArray,
    printed: bool = False,
) -> FloatArray:
    """[M*] + [I*] of the PUMA for (V, omega; q1', q2', q3') about the origin of t.

    With T_i = -[r_i] x and the Jacobians J_i of B.4: blocks sum m, sum m T, sum m J; sum m T'T,
    sum m T'J; sum m J'J. With S = sum_1..3 A_i I_i A_i': I22 = I0 + S, the rows of I32 are row 3
    of S, (I2z + I3z)(s1, -c1, 0), I3z (s1, -c1, 0), and I33(1,1) has c23^2.

    Args:
        arm: lengths.
        mass: links 0 to 3 [kg] (4,).
        com: in link frames, link 0 in the mounting frame [m] (4, 3).
        inertia: xx, yy, zz of each link about its centre of mass [kg m^2] (4, 3).
        q: joint angles [rad] (3,).
        printed: with the two slips: row 3 of I22 (with I0) in I32, and (c2 c3 + s2 s3)^2.

    Returns:
        (9, 9), without the base's own M_b.

    Source: thesis Appendix G, B.4; errata E-29, E-34, E-35.
    """
    frames = np.vstack([np.eye(4)[None], arm.transforms(q)])
    frames[0, 2, 3] = arm.d0
    rotation = frames[:, :3, :3]
    r = np.einsum("kij,kj->ki", rotation, com) + frames[:, :3, 3]
    t = -skew(r)
    j = np.zeros((4, 3, 3))
    for link in (1, 2, 3):
        j[link] = arm.jacobian(q, r[link], link)[:3]
    tt, jt = np.swapaxes(t, 1, 2), np.swapaxes(j, 1, 2)
    m = mass[:, None, None]
    m12, m13 = np.sum(m * t, axis=0), np.sum(m * j, axis=0)
    m23 = np.sum(m * tt @ j, axis=0)
    blocks = [
        [np.sum(mass) * np.eye(3), m12, m13],
        [m12.T, np.sum(m * tt @ t, axis=0), m23],
        [m13.T, m23.T, np.sum(m * jt @ j, axis=0)],
    ]
    return np.asarray(np.block(blocks) + _spin(rotation, inertia, q, printed))


def _spin(rotation: FloatArray, inertia: FloatArray, q: FloatArray, printed: bool) -> FloatArray:
    """[I*] (9, 9)."""
    s1, c1 = np.sin(q[0]), np.cos(q[0])
    s2, c2, s3, c3 = np.sin(q[1]), np.cos(q[1]), np.sin(q[2]), np.cos(q[2])
    turned = [a @ np.diag(i) @ a.T for a, i in zip(rotation, inertia, strict=True)]
    moving = turned[1] + turned[2] + turned[3]
    i22 = turned[0] + moving
    i1, i2, i3 = inertia[1], inertia[2], inertia[3]
    row3 = (i22 if printed else moving)[2]
    sideways = np.array([s1, -c1, 0.0])
    i32 = np.vstack([row3, (i2[2] + i3[2]) * sideways, i3[2] * sideways])
    cosine = c2 * c3 + s2 * s3 if printed else c2 * c3 - s2 * s3
    sine = s2 * c3 + c2 * s3
    i33 = np.zeros((3, 3))
    i33[0, 0] = i1[1] + i2[0] * s2**2 + i2[1] * c2**2 + i3[0] * sine**2 + i3[1] * cosine**2
    i33[1, 1] = i2[2] + i3[2]
    i33[1, 2] = i33[2, 1] = i33[2, 2] = i3[2]
    spin = np.zeros((9, 9))
    spin[3:6, 3:6], spin[3:6, 6:] = i22, i32.T
    spin[6:, 3:6], spin[6:, 6:] = i32, i33
    return spin
