"""on_line: a fit gone on with along the line on which each of its sizes varies."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.evidence import Evidence
from ves_twin.diagnosis.refine import Fit
from ves_twin.diagnosis.search import Search

AT = np.array([-3.0, -1.5, 0.0, 1.5, 3.0])
"""Standard deviations from the fit that are simulated: beyond a 90 % interval, and not so far that
an effect which is not linear bends chi^2 (a valve's lag does at 4.5)."""


def on_line(evidence: Evidence, fit: Fit) -> Fit:
    """The fit at the least chi^2 of each size's line, and as sure as that can be read off.

    A search ends where no step lowers chi^2. On a rig that sticks, slips or hunts, a step of all
    coordinates together may raise it by hundreds though one size is far from its best: on VES II a
    search ended 2.1 sd from it. Along v = S e / sqrt(e' S e), where S is the covariance and e the
    size, the least chi^2 is that of the full step for this size, and hardly anything else moves.
    There

        chi^2(t) = a + b t + k t^2,  t* = -b / 2k,  k = 1 where S is right

    is fitted to five points, and the fit moves to t* where that is better. What the points scatter
    about it, s, is chance of single runs: t* is known to s / (2 k sqrt(sum t^2)), which widens
    the covariance, as does k < 1.

    Args:
        evidence: whose chi^2 counts.
        fit: the end of a search.
    """
    for place in range(len(fit.sizes)):
        if evidence.runs.budget.skips("the line of a size"):
            break
        fit = _along(evidence, fit, place)
    return fit


def _along(evidence: Evidence, fit: Fit, place: int) -> Fit:
    """Of one size."""
    runs, count = evidence.runs, len(fit.sizes)
    variance = fit.posterior[place, place]
    if not variance > 0.0 or not np.isfinite(fit.chi2):
        return fit
    search = Search(evidence, fit.active[:count], fit.local)
    line = np.zeros(len(fit.shift))
    line[fit.active] = fit.posterior[:, place] / np.sqrt(variance)

    def at(t: float) -> FloatArray:
        return np.clip(fit.shift + t * line, search.low, search.high)

    ends = [at(t) for t in AT]
    reached = np.array([(end - fit.shift) @ line for end in ends]) / (line @ line)
    if not np.allclose(reached, AT, atol=0.1):  # a bound is in the way
        return fit
    chi2 = [
        search.at(end, fit.step_share).chi2 if t else fit.chi2
        for t, end in zip(AT, ends, strict=True)
    ]
    if not np.all(np.isfinite(chi2)):
        return fit
    curve, slope, least = np.polyfit(AT, chi2, 2)
    if curve <= 0.0:
        return fit
    scatter = np.linalg.norm(np.polyval((curve, slope, least), AT) - chi2) / np.sqrt(len(AT) - 3)
    chance = scatter / (2.0 * curve * np.linalg.norm(AT))
    grown = np.ones(count)
    grown[place] = np.sqrt(max(1.0, 1.0 / curve) + chance**2)
    best = float(np.clip(-slope / (2.0 * curve), AT[0], AT[-1]))
    moved = search.at(at(best), fit.step_share)
    known = np.diag(runs.sd[fit.active[:count]] ** 2)
    covariance = (fit.covariance - known) * np.outer(grown, grown) + known
    if moved.chi2 >= fit.chi2:
        return replace(fit, covariance=covariance)
    return replace(
        fit,
        shift=moved.shift,
        step_share=moved.delta,
        sizes=moved.shift[fit.active[:count]],
        covariance=covariance,
        chi2=moved.chi2,
        residual=moved.residual,
        prediction=moved.prediction,
    )
