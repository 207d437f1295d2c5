"""QuickGravity: the wrench of a gravity model at one configuration, compiled for the cycle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ves_twin.core.compiled import compiled
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.gravity.gravity_model import GravityModel
from ves_twin.mechanics.kinematics.wrenches import top_to_sensor


@dataclass(frozen=True)
class QuickGravity:
    """The numbers of a `GravityModel` as arrays; a tenth of its time for a single configuration.

    Attributes:
        rows: theta, d, a, cos alpha, sin alpha, prismatic (0 or 1) of each joint (k, 6).
        base: frame 0 in t (4, 4).
        links: first moment in its own frame [kg m] and mass [kg] of each link, as P has them
            (k + 1, 4).
        total_mass: M_total [kg].
        gravity: acceleration of gravity [m/s^2].
    """

    rows: FloatArray
    base: FloatArray
    links: FloatArray
    total_mass: float
    gravity: float

    @staticmethod
    def of(model: GravityModel) -> QuickGravity:
        """The same model."""
        chain = model.basis.chain
        rows = [
            (j.theta, j.d, j.a, np.cos(j.alpha), np.sin(j.alpha), float(j.prismatic))
            for j in chain.joints
        ]
        count = len(chain.joints) + 1
        full = np.zeros(4 * count)
        full[list(model.basis.kept)] = model.moments
        links = np.column_stack([full[: 3 * count].reshape(count, 3), full[3 * count :]])
        return QuickGravity(np.array(rows), chain.base, links, model.total_mass, model.gravity)

    def wrench_in_top(self, q: FloatArray, angles: FloatArray) -> FloatArray:
        """Gravity wrench of the payload on the platform, in t about its origin [N, N m] (6,).

        Args:
            q: joint coordinates (k,).
            angles: fixed-axis angles of the platform [rad] (3,).

        Source: thesis eqs 3.3 to 3.9, errata E-9.
        """
        return _in_top(self.rows, self.base, self.links, self.total_mass, self.gravity, q, angles)

    def wrench_in_sensor(
        self, q: FloatArray, angles: FloatArray, position: FloatArray
    ) -> FloatArray:
        """The same in s about its origin, which lies at a position in t [m] (3,)."""
        numbers = self.rows, self.base, self.links, self.total_mass, self.gravity
        return in_sensor(*numbers, q, angles, position)


@compiled
def in_sensor(
    rows: FloatArray, base: FloatArray, links: FloatArray, total_mass: float, gravity: float,
    q: FloatArray, angles: FloatArray, position: FloatArray,
) -> FloatArray:  # fmt: skip
    """`QuickGravity.wrench_in_sensor` of its numbers."""
    return top_to_sensor(_in_top(rows, base, links, total_mass, gravity, q, angles), position)


@compiled
def _in_top(
    rows: FloatArray,
    base: FloatArray,
    links: FloatArray,
    total_mass: float,
    gravity: float,
    q: FloatArray,
    angles: FloatArray,
) -> FloatArray:
    r, origin, step = base[:3, :3].copy(), base[:3, 3].copy(), np.empty((3, 3))
    moment, turned, shift = np.zeros(3), np.empty((3, 3)), np.empty(3)
    for link in range(links.shape[0]):
        if link > 0:
            theta, d, a = rows[link - 1, 0], rows[link - 1, 1], rows[link - 1, 2]
            ca, sa = rows[link - 1, 3], rows[link - 1, 4]
            if rows[link - 1, 5] > 0.0:
                d += q[link - 1]
            else:
                theta += q[link - 1]
            ct, st = np.cos(theta), np.sin(theta)
            step[0, 0], step[0, 1], step[0, 2] = ct, -st * ca, st * sa
            step[1, 0], step[1, 1], step[1, 2] = st, ct * ca, -ct * sa
            step[2, 0], step[2, 1], step[2, 2] = 0.0, sa, ca
            shift[0], shift[1], shift[2] = a * ct, a * st, d
            for i in range(3):
                for k in range(3):
                    origin[i] += r[i, k] * shift[k]
                    turned[i, k] = 0.0
                    for j in range(3):
                        turned[i, k] += r[i, j] * step[j, k]
            r[:] = turned
        for i in range(3):
            moment[i] += links[link, 3] * origin[i]
            for k in range(3):
                moment[i] += r[i, k] * links[link, k]
    sx, cx, sy, cy = np.sin(angles[0]), np.cos(angles[0]), np.sin(angles[1]), np.cos(angles[1])
    gx, gy, gz = gravity * sy, -gravity * sx * cy, -gravity * cx * cy
    result = np.empty(6)
    result[0], result[1], result[2] = total_mass * gx, total_mass * gy, total_mass * gz
    result[3] = moment[1] * gz - moment[2] * gy
    result[4] = moment[2] * gx - moment[0] * gz
    result[5] = moment[0] * gy - moment[1] * gx
    return result
