"""PeriodicSystem: a linear system whose clocks strike at different ticks, and its poles."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ves_twin.core.types import ComplexArray, FloatArray

if TYPE_CHECKING:
    from control import StateSpace

SLOWEST_LEFT = -120.0
"""Poles that decay faster than this [1/s] are lost in round-off over the 0.19 s of a period."""


@dataclass(frozen=True)
class PeriodicSystem:
    """x(k+1) = A_k x(k) + B_k u with A_k repeating after n ticks, u held for a period.

    Attributes:
        maps: A_k (n, m, m).
        inputs: B_k (n, m).
        output: y = c x (m,).
        turning: a rate r = d x (m,) whose phase tells how often a mode turns within a period;
            a position would hide fast modes behind the slow command.
        tick: time of one map [s].
    """

    maps: FloatArray
    inputs: FloatArray
    output: FloatArray
    turning: FloatArray
    tick: float

    @property
    def period(self) -> float:
        """Time after which all clocks stand as before [s]."""
        return len(self.maps) * self.tick

    def lifted(self) -> StateSpace:
        """The system seen once a period, from u to y: time-invariant, its poles are exact."""
        from control import StateSpace  # slow to import

        size = self.maps.shape[1]
        a, b = np.eye(size), np.zeros(size)
        for step, kick in zip(self.maps, self.inputs, strict=True):
            a, b = step @ a, step @ b + kick
        return StateSpace(a, b[:, None], self.output[None], [[0.0]], self.period)

    def poles(self) -> ComplexArray:
        """Poles in the s-plane [1/s], the fastest growing first.

        A period is long, so that log(z) / period alone folds all frequencies into a few hertz.
        Each mode is therefore carried through the ticks, and the turns of its rate counted:
        s = (ln |z| + i turns) / period. Poles left of SLOWEST_LEFT are left out.
        """
        values, vectors = np.linalg.eig(np.asarray(self.lifted().A))
        with np.errstate(divide="ignore"):
            rates = np.log(np.abs(values)) / self.period
        kept = rates > SLOWEST_LEFT
        turns = self._turns(vectors[:, kept])
        poles = rates[kept] + 1j * turns / self.period
        return np.asarray(poles[np.argsort(-poles.real)])

    @property
    def growth(self) -> float:
        """Real part of the fastest growing pole [1/s]; negative where the system is stable."""
        values = np.linalg.eigvals(np.asarray(self.lifted().A))
        return float(np.log(np.max(np.abs(values))) / self.period)

    def _turns(self, modes: ComplexArray) -> FloatArray:
        """Angle through which the rate of each mode turns in a period [rad]."""
        total = np.zeros(modes.shape[1])
        state = modes
        for step in self.maps:
            following = step @ state
            total += np.angle((self.turning @ following) * np.conj(self.turning @ state))
            state = following / np.linalg.norm(following, axis=0)
        return total
