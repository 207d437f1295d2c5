"""converged: several causes fitted together, down to where no step within their bounds helps."""

from __future__ import annotations

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.optimize import OptimizeResult, least_squares

from ves_twin.core.types import FloatArray, SingleArray
from ves_twin.diagnosis.bank.inner import inner
from ves_twin.diagnosis.bank.linearise import linearise
from ves_twin.diagnosis.build_up.bench import STRAINED
from ves_twin.diagnosis.fit.refine import WORTH, Fit, refine
from ves_twin.diagnosis.model.forward import Hypothesis
from ves_twin.diagnosis.record.evidence import Evidence

AGAIN = 5
"""Times that all columns are computed anew: a resonance with a cubic spring settles in four."""

STEP = 0.01
"""Of a difference, as a share of the size, or of a tenth of the range where the size is less:
predictions are in single precision."""

STEPS = 100
"""Trust-region steps at most: the numbers of a valve took 3 to 47 from eight starts."""

BETTER = "better fits of causes together"
"""What is left out where the runs are spent."""


def converged(
    evidence: Evidence, causes: tuple[Hypothesis, ...], point: FloatArray, shift: FloatArray
) -> Fit:
    """The most probable sizes of causes, within their bounds.

    By Gauss-Newton first, with true columns at every restart: a search turns its columns by the
    runs that it makes, and where causes bend each other's columns, as springs of a light resonance
    do, those turned columns stop it short of its end (Silverbox: 1.4 mV in place of 0.8).

    Its steps are cut off at the bounds. Where a step along a bound does not help, that ends it:
    seven numbers of an excavator's valve at a chi^2 of 12400, of which the same seven can leave
    4000. From there a trust region goes on, within the bounds.

    Args:
        evidence: of the fitted half.
        causes: whose parameters are free.
        point: departures where the first columns are computed (coordinates,).
        shift: departures to start from (coordinates,).
    """
    runs = evidence.runs
    local = linearise(runs, np.where(runs.sd > 0.0, point, 0.0))
    fit = refine(evidence, causes, shift, local, 1, farthest=STRAINED)
    for _ in range(AGAIN):
        if runs.budget.skips(BETTER):
            return fit
        before, local = fit.chi2, linearise(runs, fit.shift)
        fit = refine(evidence, causes, fit.shift, local, 0, fit.step_share, STRAINED)
        if before - fit.chi2 < WORTH * before:
            break
    if not causes or not np.isfinite(fit.chi2) or runs.budget.skips(BETTER):
        return fit
    there = _descended(evidence, fit)
    if there is None:
        return fit
    at = (there, linearise(runs, there), 0, fit.step_share, STRAINED)
    other = refine(evidence, causes, *at)
    return min(fit, other, key=lambda one: one.chi2)


def _descended(evidence: Evidence, fit: Fit) -> FloatArray | None:
    """Departures at the end of the trust region's steps; None where it gains nothing.

    Commissioning errors follow in closed form, by their columns at the fit.

    Source: Branch, Coleman and Li 1999, SIAM J. Sci. Comput. 21 (scipy's least_squares); Golub and
    Pereyra 1973, SIAM J. Numer. Anal. 10 (variable projection).
    """
    runs = evidence.runs
    free = fit.active[: len(fit.sizes)]
    mine = np.flatnonzero(~np.isin(runs.nuisances, free))
    others = runs.nuisances[mine]
    sd = np.append(runs.sd[others], 1.0)
    ends = np.clip([runs.low[others], runs.high[others]] / sd[:-1], -STRAINED, STRAINED)
    ends = np.append(ends, [[-np.inf], [np.inf]], axis=1)
    here = np.append(fit.shift[others], fit.step_share) / sd
    columns = evidence.whitening.apply(fit.local.columns[[*mine, len(runs.nuisances)]]).T
    factor = cho_factor(inner(columns, columns) + np.eye(len(sd)))
    low, high = runs.low[free], runs.high[free]
    begin = np.clip(fit.sizes, low, high)
    unit = np.maximum(np.abs(begin), 0.1 * (high - low))

    def at(sizes: FloatArray) -> FloatArray:
        return runs.depart(fit.shift, free, sizes * unit)

    def beside(rows: SingleArray) -> FloatArray:
        """Whitened, the pull of commissioning errors behind (samples + errors,); nan if it failed.

        The trust region shrinks then.

        Args:
            rows: predicted (rows, c).
        """
        share = np.float32(fit.step_share) * fit.local.columns[-1]
        z = evidence.whitening.apply(evidence.measured - rows - share)
        if not np.all(np.isfinite(z)):
            return np.full(len(z) + len(sd), np.nan)
        there = np.clip(here + cho_solve(factor, columns.T @ z - here), *ends)
        return np.concatenate([z - columns @ (there - here), there])

    def left(sizes: FloatArray) -> FloatArray:
        """What sizes leave, in their units; nan where slopes beyond all bounds led to no sizes."""
        if not np.all(np.isfinite(sizes)):
            return np.full(len(columns) + len(sd), np.nan)
        return beside(runs.one(at(sizes)))

    def slopes(sizes: FloatArray) -> FloatArray:
        """Of that by each size, to the side where there is room; none where the plant fails."""
        reach = STEP * np.maximum(np.abs(sizes), 0.1 * (high - low) / unit)
        reach = np.where(sizes + reach <= high / unit, reach, -reach)
        base, *found = map(beside, runs.many([at(sizes), *map(at, sizes + np.diag(reach))]))
        return np.nan_to_num(np.stack(found, axis=1) - base[:, None]) / reach

    def going(intermediate_result: OptimizeResult) -> None:
        """Ends the steps where the runs are spent; what was reached is told."""
        if runs.budget.skips(BETTER):
            raise StopIteration

    least = 0.5 * (1.0 - WORTH) * fit.chi2
    ends_at = {"ftol": WORTH, "xtol": None, "gtol": None, "max_nfev": STEPS, "callback": going}
    bounds = (low / unit, high / unit)
    found = least_squares(left, begin / unit, slopes, bounds, **ends_at)
    return runs.depart(fit.shift, free, found.x * unit) if found.cost < least else None
