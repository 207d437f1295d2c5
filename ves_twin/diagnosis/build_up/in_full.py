"""in_full: chosen trials fitted with the full forward."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.build_up.converged import converged
from ves_twin.diagnosis.build_up.proof import STRAINED
from ves_twin.diagnosis.build_up.regression import Regression
from ves_twin.diagnosis.evidence import Evidence
from ves_twin.diagnosis.refine import Fit, refine


def in_full(
    regression: Regression,
    chosen: Sequence[int],
    point: FloatArray,
    evidence: Evidence,
    probed: bool = False,
) -> Fit:
    """Most probable sizes of chosen trials, from what the linear fit says.

    And from the sizes that bent columns were computed at, the better of both: with a dead band
    and what saturates beyond it the likeliest start led to half as good a fit (the excavator).

    Args:
        regression: of the fitted half, linear about the point.
        chosen: numbers of its trials.
        point: departures (coordinates,).
        evidence: of the fitted half.
        probed: whether intervals follow what the full forward leaves beside the fit.
    """
    runs = evidence.runs
    linear = regression.solve(chosen, evidence.whitening)
    full = np.where(runs.sd > 0.0, point, 0.0)
    near, half, told = full, full, full
    for n, at in regression.places(chosen).items():
        trial = regression.trials[n]
        where = runs.indices(trial.cause)
        sizes = trial.departures(linear.shares[at] * linear.scale[at])
        full = runs.depart(full, where, sizes)
        told = runs.depart(told, where, np.array(trial.sizes) if trial.bent else full[where])
        here = point[where] if np.any(point[where]) else full[where]
        near = runs.depart(near, where, here)
        half = runs.depart(half, where, 0.5 * (here + full[where]))
    causes = tuple(regression.trials[n].cause for n in chosen)
    starts = (_likeliest(evidence, (full, half, near)), told)
    different = {shift.tobytes(): shift for shift in starts}
    fits = [converged(evidence, causes, point, shift) for shift in different.values()]
    fit = min(fits, key=lambda one: one.chi2)
    if not probed:
        return fit
    end = (fit.shift, fit.local, 0, fit.step_share)
    return refine(evidence, causes, *end, farthest=STRAINED, probed=True)


def _likeliest(evidence: Evidence, starts: Sequence[FloatArray]) -> FloatArray:
    """The start that leaves least: columns of finite sizes may promise what none of them keeps.

    Seen on the excavator.
    """

    def left(shift: FloatArray) -> float:
        rows = evidence.whitening.apply(evidence.measured - evidence.runs.one(shift))
        chi2 = float(rows @ rows)
        return chi2 if np.isfinite(chi2) else np.inf

    different = {shift.tobytes(): shift for shift in starts}
    return min(different.values(), key=left)
