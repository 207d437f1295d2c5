"""on_line: a fit gone on with along the line on which each of its sizes varies."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.fit.refine import Fit
from ves_twin.diagnosis.fit.search import Point, Search
from ves_twin.diagnosis.record.evidence import Evidence

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
    """Of one size; as it was where a bound is in the way, or chi^2 has no least there."""
    runs, count, variance = evidence.runs, len(fit.sizes), fit.posterior[place, place]
    if not variance > 0.0 or not np.isfinite(fit.chi2):
        return fit
    search = Search(evidence, fit.active[:count], fit.local, fit.farthest)
    line = np.zeros(len(fit.shift))
    line[fit.active] = fit.posterior[:, place] / np.sqrt(variance)

    def at(t: float) -> Point:
        return search.at(np.clip(fit.shift + t * line, search.low, search.high), fit.step_share)

    axis = fit.active[place]
    ends = fit.shift[axis] + AT * line[axis]
    if np.any(ends < runs.low[axis]) or np.any(ends > runs.high[axis]):
        return fit
    chi2 = np.array([at(t).chi2 if t else fit.chi2 for t in AT])
    curve, slope, least = np.polyfit(AT, chi2, 2) if np.all(np.isfinite(chi2)) else np.zeros(3)
    if curve <= 0.0:
        return fit
    scatter = np.linalg.norm(np.polyval((curve, slope, least), AT) - chi2) / np.sqrt(len(AT) - 3)
    chance = scatter / (2.0 * curve * np.linalg.norm(AT))
    sure = _wider(fit, place, float(np.sqrt(max(1.0, 1.0 / curve) + chance**2)), runs.sd)
    moved = at(float(np.clip(-slope / (2.0 * curve), AT[0], AT[-1])))
    return _at(sure, moved) if moved.chi2 < fit.chi2 else sure


def _wider(fit: Fit, place: int, times: float, sd: FloatArray) -> Fit:
    """With what the record tells of one size so many times wider; commissioning tells the rest."""
    count = len(fit.sizes)
    grown, known = np.ones(count), np.diag(sd[fit.active[:count]] ** 2)
    grown[place] = times
    return replace(fit, covariance=(fit.covariance - known) * np.outer(grown, grown) + known)


def _at(fit: Fit, point: Point) -> Fit:
    """Elsewhere, with the columns and the covariance that it has."""
    return replace(
        fit,
        shift=point.shift,
        step_share=point.delta,
        sizes=point.shift[fit.active[: len(fit.sizes)]],
        chi2=point.chi2,
        residual=point.residual,
        prediction=point.prediction,
    )
