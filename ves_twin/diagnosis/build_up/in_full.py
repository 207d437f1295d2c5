"""in_full: chosen trials fitted with the full forward."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.build_up.bench import STRAINED
from ves_twin.diagnosis.build_up.converged import converged
from ves_twin.diagnosis.build_up.regression import Regression
from ves_twin.diagnosis.fit.refine import Fit, refine
from ves_twin.diagnosis.model.forward import Hypothesis
from ves_twin.diagnosis.record.evidence import Evidence


def in_full(
    regression: Regression,
    chosen: Sequence[int],
    point: FloatArray,
    evidence: Evidence,
    probed: bool = False,
    known: Fit | None = None,
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
        known: an earlier fit, which is gone on from if it is of the same causes.
    """
    causes = tuple(regression.trials[n].cause for n in chosen)
    if known is None or known.causes != causes:
        known = _begun(regression, chosen, point, evidence, causes)
    if not probed:
        return known
    end = (known.shift, known.local, 0, known.step_share)
    return refine(evidence, causes, *end, farthest=STRAINED, probed=True)


def _begun(
    regression: Regression,
    chosen: Sequence[int],
    point: FloatArray,
    evidence: Evidence,
    causes: tuple[Hypothesis, ...],
) -> Fit:
    """The better one of the fits from the likeliest start and from the sizes of bent columns."""
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
    starts = (_likeliest(evidence, (full, half, near)), told)
    different = {shift.tobytes(): shift for shift in starts}
    fits = [converged(evidence, causes, point, shift) for shift in different.values()]
    return min(fits, key=lambda one: one.chi2)


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
