"""GravityModel: M_total and P, the minimal model that predicts the wrench of gravity."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ves_twin.core.read_only import ReadOnly
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.gravity.first_moments import FirstMoments
from ves_twin.mechanics.kinematics.dh_chain import DhChain


@dataclass(frozen=True)
class GravityModel(ReadOnly):
    """F_g = M_total g, M_g = G(q, g) P, about the origin of the platform top frame t.

    Attributes:
        basis: which first moments P holds.
        total_mass: M_total [kg].
        moments: P [kg m] (p,).
        gravity: acceleration of gravity [m/s^2].

    Source: thesis eqs 3.3 to 3.9, errata E-9.
    """

    basis: FirstMoments
    total_mass: float
    moments: FloatArray
    gravity: float

    @staticmethod
    def of(chain: DhChain, mass: FloatArray, com: FloatArray, gravity: float) -> GravityModel:
        """The model of links of known mass [kg] (k + 1,) and centre in its frame [m] (k + 1, 3)."""
        basis = FirstMoments.of(chain)
        return GravityModel(basis, float(np.sum(mass)), basis.parameters(mass, com), gravity)

    def wrench_in_top(self, q: FloatArray, angles: FloatArray) -> FloatArray:
        """Gravity wrenches of the payload on the platform.

        Args:
            q: joint coordinates (n, k).
            angles: fixed-axis angles of the platform [rad] (n, 3).

        Returns:
            Force and moment in t, about its origin [N, N m] (n, 6).
        """
        g = gravity_in_top(angles, self.gravity)
        first = self.basis.regressor(q) @ self.moments
        return np.hstack([self.total_mass * g, np.cross(first, g)])

    def holding_torque(self, q: FloatArray, angles: FloatArray) -> FloatArray:
        """Torques or forces of the joints that hold the arm against gravity: -g . dS/dq.

        S is the first moment of the whole arm. It is a sine of each revolute joint and linear in
        each prismatic one, so a central difference over half pi, divided by 2 or by pi, is exact.

        Args:
            q: joint coordinates (n, k).
            angles: fixed-axis angles of the platform [rad] (n, 3).

        Returns:
            One for each joint [N m, N] (n, k).
        """
        g = gravity_in_top(angles, self.gravity)
        torque = np.empty(q.shape)
        for j, joint in enumerate(self.basis.chain.joints):
            step = np.zeros(q.shape[1])
            step[j] = np.pi / 2
            ahead, behind = self.basis.regressor(q + step), self.basis.regressor(q - step)
            span = np.pi if joint.prismatic else 2.0
            torque[:, j] = -np.sum((ahead - behind) @ self.moments * g, axis=1) / span
        return torque


def gravity_in_top(angles: FloatArray, gravity: float) -> FloatArray:
    """Acceleration of gravity in t [m/s^2] (n, 3): g (sin y, -sin x cos y, -cos x cos y).

    Args:
        angles: fixed-axis angles of the platform [rad] (n, 3).
        gravity: its size [m/s^2].

    Source: thesis eq. 3.4, errata E-1, E-9.
    """
    sx, cx = np.sin(angles[:, 0]), np.cos(angles[:, 0])
    sy, cy = np.sin(angles[:, 1]), np.cos(angles[:, 1])
    return gravity * np.column_stack([sy, -sx * cy, -cx * cy])
