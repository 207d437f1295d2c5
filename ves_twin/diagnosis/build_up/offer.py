"""Offer: chosen trials fitted in full; preferred: which of several to keep."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.build_up.discrepancy import discrepancy
from ves_twin.diagnosis.build_up.memory import independent_rows
from ves_twin.diagnosis.build_up.regression import Regression
from ves_twin.diagnosis.build_up.select import Selector
from ves_twin.diagnosis.evidence import Evidence
from ves_twin.diagnosis.refine import Fit, bare_residual


@dataclass(frozen=True)
class Offer:
    """Chosen trials, fitted with the full forward.

    Attributes:
        chosen: numbers of the trials.
        evidence: that they were fitted to.
        fit: of their causes.
        residual: what they leave (rows, c).
        rms: of each channel of it (c,).
    """

    chosen: list[int]
    evidence: Evidence
    fit: Fit
    residual: FloatArray
    rms: FloatArray

    @staticmethod
    def of(regression: Regression, chosen: list[int], evidence: Evidence, fit: Fit) -> Offer:
        """With what a fit leaves."""
        residual = np.asarray(bare_residual(evidence, fit), float)
        rms = np.maximum(regression.half.rms(residual), 1e-30)
        return Offer(chosen, evidence, fit, residual, rms)

    @property
    def left(self) -> float:
        """Mean logarithm of the rms of all channels."""
        return float(np.mean(np.log(self.rms)))


def preferred(regression: Regression, offers: Sequence[Offer]) -> Offer:
    """The offer with the best odds by two views of what it leaves, each less its price.

        2 log odds = rows log det W^2 - price(samples) - sum_c n_c log rms_c^2 - price(n)

    One step ahead, W the whitening that the residual asks for: where rows are finer than what
    happens in them, declared noise is larger than any step, and all offers look alike (the
    excavator). And altogether, n_c being rows over twice their memory, of the offer that leaves
    least: where what is left is slow, few rows are independent, and what is faster counts for
    little. A choice without a price takes more causes, and false ones (the workshop's arm).

    Args:
        regression: that the trials belong to.
        offers: one at least.
    """
    if len(offers) == 1:
        return offers[0]
    count = independent_rows(regression.half.runs, min(offers, key=lambda one: one.left).residual)
    return max(offers, key=lambda one: _odds(regression, one, count))


def _odds(regression: Regression, offer: Offer, count: FloatArray) -> float:
    """Twice the logarithm of the odds of an offer, up to what all have in common."""
    price = Selector(regression).price
    width = sum(regression.trials[n].width for n in offer.chosen)
    whitening = discrepancy(regression.half.runs, offer.residual)
    samples = float(np.sum(whitening.freedom))
    _, size = np.linalg.slogdet(whitening.mixing[0])
    ahead = 2.0 * samples / len(whitening.mixing[0]) * size - price(samples, width)
    altogether = -2.0 * float(count @ np.log(offer.rms)) - price(float(np.sum(count)), width)
    return float(ahead + altogether)
