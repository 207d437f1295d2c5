"""Sensitivity: how the signals at a set of poses depend on gain, zero, M_total and P."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.mechanics.gravity.first_moments import FirstMoments

AXES = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")

GAIN, ZERO, MASS = slice(0, 36), slice(36, 42), slice(42, None)
"""Where the unknowns lie: shares E of the gain row by row, zero b, then M_total and P."""


@dataclass(frozen=True)
class Sensitivity:
    """The model s = A (B x + l) + b with A = 1 + R E / R, R the full scales on the diagonal.

    E[i, j] is what axis i shows for a full-scale load on axis j, as a share of its full scale:
    gain errors on the diagonal, cross-talk off it.

    Attributes:
        regressor: B (n, 6, 1 + p), wrench in the sensor per (M_total, P).
        known: l (n, 6), wrench of known weights [N, N m].
        full_scale: R [N, N m] (6,).
        basis: names of P.
    """

    regressor: FloatArray
    known: FloatArray
    full_scale: FloatArray
    basis: FirstMoments

    @property
    def names(self) -> tuple[str, ...]:
        """Name of every unknown, in order."""
        gains = [f"gain {i} from {j}" for i in AXES for j in AXES]
        return (*gains, *(f"zero {i}" for i in AXES), "M_total", *self.basis.names)

    @property
    def start(self) -> FloatArray:
        """The unknowns of an ideal sensor under nothing (42 + 1 + p,)."""
        return np.zeros(42 + self.regressor.shape[2])

    def gain(self, unknowns: FloatArray) -> FloatArray:
        """A (6, 6), signal per wrench."""
        share = unknowns[GAIN].reshape(6, 6)
        return np.eye(6) + share * np.outer(self.full_scale, 1.0 / self.full_scale)

    def wrench(self, unknowns: FloatArray) -> FloatArray:
        """True wrench in the sensor at each pose [N, N m] (n, 6)."""
        return np.asarray(self.regressor @ unknowns[MASS] + self.known)

    def signal(self, unknowns: FloatArray) -> FloatArray:
        """Signals at each pose (n, 6)."""
        return np.asarray(self.wrench(unknowns) @ self.gain(unknowns).T + unknowns[ZERO])

    def jacobian(self, unknowns: FloatArray) -> FloatArray:
        """Signals per unknown (n, 6, 42 + 1 + p)."""
        n, _, count = self.regressor.shape
        result = np.zeros((n, 6, 42 + count))
        wrench = self.wrench(unknowns) / self.full_scale
        for i in range(6):
            result[:, i, 6 * i : 6 * i + 6] = self.full_scale[i] * wrench
            result[:, i, 36 + i] = 1.0
        result[:, :, MASS] = self.gain(unknowns) @ self.regressor
        return result

    def gauge(self, unknowns: FloatArray) -> dict[str, FloatArray]:
        """Five changes of the unknowns that no gravity pose can see, by name.

        A wrench T w instead of w with A / T instead of A gives the same signals. T w is again a
        wrench of gravity for T a gain of all forces, a gain of all moments, or a moment v x F
        (the first moment of the base shifts along): five directions. A known weight breaks them.

        Returns:
            Name -> direction (42 + 1 + p,).
        """
        wrench, gain = self.wrench(unknowns) - self.known, self.gain(unknowns)
        n, _, count = self.regressor.shape
        columns = self.regressor.reshape(6 * n, count)
        ratio = np.outer(1.0 / self.full_scale, self.full_scale)
        found = {}
        for name, change in _changes().items():
            direction = np.zeros_like(unknowns)
            direction[GAIN] = ((-gain @ change) * ratio).ravel()
            answer = (wrench @ change.T).ravel()
            direction[MASS] = np.linalg.lstsq(columns, answer, rcond=None)[0]
            found[name] = direction
        return found


def _changes() -> dict[str, FloatArray]:
    force, moment = np.diag([1.0] * 3 + [0.0] * 3), np.diag([0.0] * 3 + [1.0] * 3)
    found = {"force gain against M_total": force, "moment gain against P": moment}
    for axis, (i, j) in zip("xyz", ((1, 2), (2, 0), (0, 1)), strict=True):
        lever = np.zeros((6, 6))
        lever[3 + i, j], lever[3 + j, i] = -1.0, 1.0
        found[f"moment per force along {axis} against link 0 {axis}"] = lever
    return found
