"""LaggingBaseArm: linear dynamics of an arm on a platform that follows its base late."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import ComplexArray, FloatArray
from ves_twin.mechanics.emulated import EmulatedSystem
from ves_twin.mechanics.planning.flexible_base import JointGains, joint_matrix, poles_of
from ves_twin.mechanics.planning.pped import quadratic_integral


@dataclass(frozen=True)
class LaggingBaseArm:
    """What is left of an emulated base when six legs of finite bandwidth carry it.

    The computed base Y feels the wrench of an arm that rides on the platform P:

        M Y'' + B Y' + K Y = -(H_bb P'' + H_bq q''),   H_bq' P'' + H_qq q'' + B_r q' + K_r q = 0
        lag P'' + P' = gain (Y - P)

    For slow motion P follows by tau = 1 / gain, so that the wrench -H Y''(t - tau) is about
    -H Y'' - tau w^2 H Y': the legs damp the base by tau w^2 H, whatever the joints do.

    Attributes:
        arm_mass: H about a configuration (6 + n, 6 + n).
        base: the emulated base.
        gains: of the joints.
        gain: of the leg loops [1/s].
        lag: of the valves [s].

    Source: thesis 4.3.2 with the legs of 5.1; the limit tau -> 0 is `FlexibleBaseArm`.
    """

    arm_mass: FloatArray
    base: EmulatedSystem
    gains: JointGains
    gain: float
    lag: float

    def __post_init__(self) -> None:
        if not (self.gain > 0 and self.lag > 0):
            raise InvalidInputError("legs", (self.gain, self.lag), "gain and lag above zero")

    @property
    def state_matrix(self) -> FloatArray:
        """A of x' = A x, x = (Y, Y', P, P', q - q0, q') (24 + 2 n,) square."""
        n = len(self.arm_mass) - 6
        h_bb, h_bq, h_qq = self.arm_mass[:6, :6], self.arm_mass[:6, 6:], self.arm_mass[6:, 6:]
        size = 24 + 2 * n
        select = np.eye(size)
        y, y_rate, p, p_rate = (select[6 * k : 6 * k + 6] for k in range(4))
        q, q_rate = select[24 : 24 + n], select[24 + n :]
        follows = (self.gain * (y - p) - p_rate) / self.lag
        springs = joint_matrix(self.gains.stiffness, n, "stiffness") @ q
        dampers = joint_matrix(self.gains.damping, n, "damping") @ q_rate
        joints = -np.linalg.solve(h_qq, h_bq.T @ follows + springs + dampers)
        load = self.base.stiffness @ y + self.base.damping @ y_rate
        base = -np.linalg.solve(self.base.mass, load + h_bb @ follows + h_bq @ joints)
        return np.vstack([y_rate, base, p_rate, follows, q_rate, joints])

    def poles(self) -> ComplexArray:
        """Poles [1/s] by rising magnitude (24 + 2 n,)."""
        return poles_of(self.state_matrix)

    def energy_integral(self, start: FloatArray, until: float) -> float:
        """Integral of 1/2 P' K P after a release at rest from a pose [J s]; inf if unstable.

        Args:
            start: of base and platform [m, rad] (6,).
            until: end of the integral [s].
        """
        a = self.state_matrix
        energy = np.zeros_like(a)
        energy[12:18, 12:18] = 0.5 * self.base.stiffness
        state = np.zeros(len(a))
        state[:6] = state[12:18] = start
        return quadratic_integral(a, energy, state, until)
