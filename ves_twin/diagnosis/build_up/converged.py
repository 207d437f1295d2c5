"""converged: several causes fitted together until columns computed anew no longer help."""

from __future__ import annotations

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.evidence import Evidence
from ves_twin.diagnosis.forward import Hypothesis
from ves_twin.diagnosis.linearise import linearise
from ves_twin.diagnosis.refine import WORTH, Fit, refine

AGAIN = 5
"""Times that all columns are computed anew: a resonance with a cubic spring settles in four."""


def converged(
    evidence: Evidence, causes: tuple[Hypothesis, ...], point: FloatArray, shift: FloatArray
) -> Fit:
    """The most probable sizes of causes, by Gauss-Newton with true columns at every restart.

    A search turns its columns by the runs that it makes. Where causes bend each other's columns, as
    springs of a light resonance do, those turned columns stop a search short of its end: with a
    cubic spring and two offsets at 1.4 mV, where columns anew come to 0.8 (Silverbox).

    Args:
        evidence: of the fitted half.
        causes: whose parameters are free.
        point: departures where the first columns are computed (coordinates,).
        shift: departures to start from (coordinates,).
    """
    runs = evidence.runs
    local = linearise(runs, np.where(runs.sd > 0.0, point, 0.0))
    fit = refine(evidence, causes, shift, local, 1)
    for _ in range(AGAIN):
        if runs.budget.skips("better fits of causes together"):
            break
        before, local = fit.chi2, linearise(runs, fit.shift)
        fit = refine(evidence, causes, fit.shift, local, 0, fit.step_share)
        if before - fit.chi2 < WORTH * before:
            break
    return fit
