"""VirtualManipulator: massless links from the common centre of mass to a point of the arm."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.planning.chain import SerialChain
from ves_twin.mechanics.planning.flexible_base import JointGains


@dataclass(frozen=True)
class VirtualManipulator:
    """The arm as links without mass on the virtual base, the centre of mass of the whole system.

    The point is at x_cm + sum_k R_k v_k. A virtual link v_k is parallel to what it stands for in
    link k and turns with it, and for a free-floating arm x_cm does not move.

    Attributes:
        chain: the arm.
        links: v_k in the base frame at q = 0 [m] (n + 1, 3).

    Source: thesis 4.3.1, B.5, B.6 (after Vafa and Dubowsky 1990); lengths errata E-41.
    """

    chain: SerialChain
    links: FloatArray

    @staticmethod
    def to(chain: SerialChain, point: FloatArray, link: int) -> VirtualManipulator:
        """To a point fixed to a link.

        With P_k the joint of link k (P_0 the base origin), c_k its centre of mass, m_k its mass
        and M the total, a link before the point's own has
        v_k = (P_(k+1) - P_k) (m_0 + ... + m_k)/M - (c_k - P_k) m_k/M.

        Args:
            chain: the arm; its base link's mass may hold that of a free base.
            point: in the base frame at q = 0 [m] (3,).
            link: 0 to n.

        Raises:
            InvalidInputError: no such link, or an arm without mass.
        """
        n, total = chain.joints, float(np.sum(chain.mass))
        if not 0 <= link <= n:
            raise InvalidInputError("virtual manipulator link", link, f"0 to {n}")
        if not total > 0:
            raise InvalidInputError("chain mass", chain.mass.tolist(), "a sum above zero")
        joints = np.vstack([np.zeros(3), chain.points, chain.tip])
        spans = np.diff(joints, axis=0)
        beyond = (total - np.cumsum(chain.mass)) / total
        links = -beyond[:, None] * spans
        links -= chain.mass[:, None] / total * (chain.com - joints[:-1])
        links[:link] += spans[:link]
        links[link] += np.asarray(point, float) - joints[link]
        return VirtualManipulator(chain, links)

    @staticmethod
    def to_endpoint(chain: SerialChain) -> VirtualManipulator:
        """To the end of the last link (thesis B.5)."""
        return VirtualManipulator.to(chain, chain.tip, chain.joints)

    @staticmethod
    def to_base(chain: SerialChain) -> VirtualManipulator:
        """To the centre of mass of link 0, the end that carries the base (thesis B.6)."""
        return VirtualManipulator.to(chain, chain.com[0], 0)

    def reach(self, q: FloatArray) -> FloatArray:
        """From the centre of mass to the point, base axes [m] (..., 3), at q [rad] (..., n)."""
        rotation, _ = self.chain.displacements(q)
        return np.asarray(np.einsum("...kij,kj->...i", rotation, self.links))

    def jacobian(self, q: FloatArray) -> FloatArray:
        """Velocity of the point per joint rate, base not turning [m] (..., 3, n).

        Column j is z_j x sum_(k >= j) R_k v_k.
        """
        rotation, _ = self.chain.displacements(q)
        _, axes = self.chain.axes_at(q)
        turned = np.einsum("...kij,kj->...ki", rotation, self.links)
        outer = np.cumsum(turned[..., ::-1, :], axis=-2)[..., ::-1, :]
        return np.asarray(np.swapaxes(np.cross(axes, outer[..., 1:, :]), -1, -2))

    def joint_gains(
        self, stiffness_wanted: FloatArray, damping_wanted: FloatArray, q: FloatArray
    ) -> JointGains:
        """Joint gains that give the point a stiffness K_d and damping B_d at q.

        K_vm = J' K_d J and B_vm = J' B_d J.

        Args:
            stiffness_wanted: K_d [N/m] (3, 3).
            damping_wanted: B_d [N s/m] (3, 3).
            q: joint angles [rad] (n,).

        Source: thesis eqs 4.1, 4.2.
        """
        jacobian = self.jacobian(q)
        return JointGains(
            np.asarray(jacobian.T @ stiffness_wanted @ jacobian),
            np.asarray(jacobian.T @ damping_wanted @ jacobian),
        )
