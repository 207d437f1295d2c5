"""Offer: chosen trials fitted in full; preferred: which of several to keep."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.build_up.memory import independent_rows
from ves_twin.diagnosis.build_up.regression import Regression
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
        rms = np.maximum(regression.half.rms(residual), regression.quietest)
        return Offer(chosen, evidence, fit, residual, rms)

    @property
    def left(self) -> float:
        """Mean logarithm of the rms of all channels."""
        return float(np.mean(np.log(self.rms)))


def preferred(regression: Regression, offers: Sequence[Offer]) -> Offer:
    """The offer with the best odds by what it leaves, less its price.

        2 log odds = -sum_c n_c log rms_c^2 - price(sum_c n_c)

    n_c are rows over twice their memory, of the offer that leaves least: where what is left is
    slow, few rows are independent. Judged by one-step prediction errors as well, more causes were
    taken, and held-out rows were told worse: model error does not repeat there (the damper).
    Without a price there were false ones (the workshop's arm).

    Args:
        regression: that the trials belong to.
        offers: one at least.
    """
    best = min(offers, key=lambda one: one.left)
    count = independent_rows(regression.half.runs, best.residual)

    def odds(offer: Offer) -> float:
        price = regression.price(float(np.sum(count)), regression.width(offer.chosen))
        return -2.0 * float(count @ np.log(offer.rms)) - price

    return max(offers, key=odds)
