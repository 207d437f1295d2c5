"""Offer: what is proved of one choice of causes, fitted in full; preferred: which one to keep."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.build_up.halves import Halves, carried_point
from ves_twin.diagnosis.build_up.memory import independent_rows
from ves_twin.diagnosis.build_up.proof import NULL_FROM, Proof
from ves_twin.diagnosis.build_up.regression import Half
from ves_twin.diagnosis.fit.refine import Fit

FAILED = 1e30
"""Rms that stands for a simulation that broke off: worse than any that did not."""


@dataclass(frozen=True)
class Offer:
    """What is proved of one choice of causes.

    Attributes:
        halves: linear about a full fit of the choice.
        point: that fit's departures (coordinates,).
        proof: of the choice.
        fit: of all that is proved, with the full forward.
        known: labels of all causes that were put to proof so far.
        held_out: what the fit leaves of held-out rows (rows, c).
    """

    halves: Halves
    point: FloatArray
    proof: Proof
    fit: Fit
    known: frozenset[str]
    held_out: FloatArray

    @staticmethod
    def of(
        halves: Halves, point: FloatArray, proof: Proof, fit: Fit, known: frozenset[str]
    ) -> Offer:
        """With what is left of held-out rows, what is drawn anew for each recording taken off."""
        held, level = halves.held, halves.regression.level
        there = held.runs.one(carried_point(halves.regression.half.runs, held.runs, fit.shift))
        left = np.where(held.kept, halves.measured - there, 0.0)
        own = np.where(held.kept, held.own, 0.0)
        columns, rows = (own / level).reshape(len(own), left.size), (left / level).ravel()
        power = float(rows @ rows) / max(int(np.count_nonzero(held.kept)), 1) + 1e-30
        shares = np.linalg.solve(
            columns @ columns.T / power + np.eye(len(own)), columns @ rows / power
        )
        left = np.asarray(left - np.tensordot(shares, own, axes=1), float)
        return Offer(halves, point, proof, fit, known, left)

    @property
    def proved(self) -> frozenset[str]:
        """Labels of causes that are proved."""
        trials = self.halves.regression.trials
        return frozenset(trials[n].cause.label for n in self.proof.proved)

    @property
    def rejected(self) -> frozenset[str]:
        """Labels of causes that held-out rows speak against."""
        trials, dropped = self.halves.regression.trials, self.proof.dropped
        return frozenset(trials[n].cause.label for n, p in dropped.items() if p > NULL_FROM)

    def over(self, other: Offer) -> float:
        """Nats by which it leaves less of held-out rows than another one, see `left_of`."""
        quietest = self.halves.regression.quietest
        mine, theirs = left_of(self.halves.held, quietest, [self.held_out, other.held_out])
        return float(theirs - mine)


def preferred(offers: Sequence[Offer]) -> Offer:
    """The offer that predicts held-out rows best, the first of equals.

    Args:
        offers: one at least.
    """
    halves = offers[0].halves
    return offers[least_left(halves.held, halves.regression.quietest, [o.held_out for o in offers])]


def least_left(held: Half, quietest: FloatArray, left: Sequence[FloatArray]) -> int:
    """Which of several residuals leaves least of held-out rows, the first of equals; see `left_of`.

    Args:
        held: the held-out half.
        quietest: rms of each channel below which nothing is told (c,).
        left: (rows, c) each, one at least.
    """
    return int(np.argmin(left_of(held, quietest, left)))


def left_of(held: Half, quietest: FloatArray, left: Sequence[FloatArray]) -> FloatArray:
    """How much each of several residuals leaves of held-out rows (k,).

        sum_c n_c log rms_c

    n_c are held-out rows over twice their memory, of the residual that leaves least: where what is
    left is slow, few rows are independent.

    Args:
        held: the held-out half.
        quietest: rms of each channel below which nothing is told (c,).
        left: (rows, c) each, one at least.
    """
    told = np.array([held.rms(one) for one in left])
    rms = np.log(np.maximum(np.where(np.isfinite(told), told, FAILED), quietest))
    best = left[int(np.argmin([np.sum(one) for one in rms]))]
    count = independent_rows(held.runs, best)
    return np.array([float(count @ one) for one in rms])
