"""FlexibleBaseArm: linear dynamics of an arm with joint springs and dampers on a flexible base."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag, expm

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import ComplexArray, FloatArray
from ves_twin.mechanics.emulated import EmulatedSystem
from ves_twin.mechanics.planning.chain import SerialChain


@dataclass(frozen=True)
class JointGains:
    """Position and rate gains of the joints, tau = -K_r (q - q0) - B_r q'.

    Attributes:
        stiffness: K_r, a diagonal (n,) or full (n, n) [N m/rad].
        damping: B_r, a diagonal (n,) or full (n, n) [N m s/rad].
    """

    stiffness: FloatArray
    damping: FloatArray


PPED_GAINS = JointGains(np.array([210.0, 33.0, 20.0]), np.array([72.0, 55.0, 17.0]))
"""Source: thesis eq. 4.5."""

HIGH_GAINS = JointGains(np.array([3000.0, 2000.0, 1000.0]), np.array([50.0, 40.0, 30.0]))
"""Source: thesis eq. 4.6."""


@dataclass(frozen=True)
class FlexibleBaseArm:
    """M* x'' + B* x' + K* x = 0 about a configuration, x = (Y of the base, q - q0).

    Attributes:
        mass: M* = blkdiag(M_b, 0) + H(q0) (6 + n, 6 + n).
        damping: B* = blkdiag(B_b, B_r) (6 + n, 6 + n).
        stiffness: K* = blkdiag(K_b, K_r) (6 + n, 6 + n).

    Source: thesis 4.3.2, Appendix G; errata E-34.
    """

    mass: FloatArray
    damping: FloatArray
    stiffness: FloatArray

    @staticmethod
    def about(
        chain: SerialChain, base: EmulatedSystem, q: FloatArray, gains: JointGains
    ) -> FlexibleBaseArm:
        """The linear dynamics of a chain on a base about joint angles q [rad] (n,), base at zero.

        Raises:
            InvalidInputError: gains or angles for another number of joints.
        """
        return FlexibleBaseArm.of(chain.mass_matrix(np.asarray(q, float)), base, gains)

    @staticmethod
    def of(arm_mass: FloatArray, base: EmulatedSystem, gains: JointGains) -> FlexibleBaseArm:
        """The same from the arm's mass matrix H (6 + n, 6 + n)."""
        n = len(arm_mass) - 6
        mass = np.array(arm_mass, float)
        mass[:6, :6] += base.mass
        return FlexibleBaseArm(
            mass,
            block_diag(base.damping, joint_matrix(gains.damping, n, "damping")),
            block_diag(base.stiffness, joint_matrix(gains.stiffness, n, "stiffness")),
        )

    @property
    def state_matrix(self) -> FloatArray:
        """A of (x, x')' = A (x, x'), (2 (6 + n),) square. Source: thesis eq. 4.3."""
        size = len(self.mass)
        a = np.zeros((2 * size, 2 * size))
        a[:size, size:] = np.eye(size)
        solved = np.linalg.solve(self.mass, np.hstack([self.stiffness, self.damping]))
        a[size:, :size], a[size:, size:] = -solved[:, :size], -solved[:, size:]
        return a

    def poles(self) -> ComplexArray:
        """Poles [1/s] by rising magnitude (2 (6 + n),)."""
        return poles_of(self.state_matrix)

    def release(self, start: FloatArray, times: FloatArray) -> FloatArray:
        """Motion after a release at rest from a pose of the base, joints at q0.

        Args:
            start: Y(0) [m, rad] (6,).
            times: evenly spaced, from zero [s] (k,).

        Returns:
            x = (Y, q - q0) (k, 6 + n).
        """
        size = len(self.mass)
        state = np.zeros(2 * size)
        state[:6] = start
        step = expm(self.state_matrix * (times[1] - times[0]))
        states = np.empty((len(times), size))
        for k in range(len(times)):
            states[k] = state[:size]
            state = step @ state
        return states


def strain_energy(base: EmulatedSystem, poses: FloatArray) -> FloatArray:
    """Energy in the base, sum_ij 1/2 k_ij Y_i Y_j [J] (...), at poses (..., 6).

    Source: thesis 4.2.
    """
    return np.asarray(0.5 * np.einsum("...i,ij,...j->...", poses, base.stiffness, poses))


def poles_of(state_matrix: FloatArray) -> ComplexArray:
    """Poles [1/s] by rising magnitude (n,)."""
    poles = np.linalg.eigvals(state_matrix).astype(complex)
    return np.asarray(poles[np.lexsort((poles.imag, np.abs(poles).round(9)))])


def joint_matrix(gains: FloatArray, n: int, what: str) -> FloatArray:
    """Gains of n joints, (n,) or full, as a matrix (n, n); refused if they are for others."""
    array = np.asarray(gains, float)
    if array.shape not in {(n,), (n, n)} or not np.all(np.isfinite(array)):
        came = array.tolist()
        raise InvalidInputError(f"joint {what}", came, f"{n} finite numbers, or {n} rows of {n}")
    return np.diag(array) if array.ndim == 1 else array
