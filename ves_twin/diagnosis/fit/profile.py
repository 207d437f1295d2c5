"""profiled: a fit whose sizes are known as the profile of chi^2 says, not its slope at the end."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.fit.refine import Fit, refine
from ves_twin.diagnosis.model.forward import Hypothesis
from ves_twin.diagnosis.record.evidence import Evidence

AT = 1.645
"""Standard deviations from the best size at which the profile is taken first: a 90 % interval."""

RISE = 1.0
"""Rise of chi^2 that tells a standard deviation; less is no more than how well a search ends."""

Causes = tuple[Hypothesis, ...]

DOUBLED = 4
"""Times that the distance is doubled where chi^2 has not risen by that."""


def profiled(evidence: Evidence, fit: Fit) -> Fit:
    """The fit with wider covariances where chi^2 rises less than its Jacobian says.

    The profile of a size is the least chi^2 with that size held and all else free. Its standard
    deviation is the distance over the root of the rise, on both sides. Dry friction bends the
    columns of commissioning errors, so that a Jacobian at the fit claims more than the record
    tells: six times more of 0.15 N m on the pendulum.

    Sizes that commissioning knows too, and those of causes of several parameters, stay as they are;
    so does the posterior, by which gains are judged.

    Args:
        evidence: what was measured.
        fit: the most probable point.
    """
    grown = np.ones(len(fit.sizes))
    for place, cause in _single(fit):
        if fit.local.runs.sd[fit.active[place]] > 0.0:
            continue
        others = tuple(other for other in fit.causes if other is not cause)
        sd = float(np.sqrt(fit.covariance[place, place]))
        sides = [_side(evidence, fit, others, place, sign * sd) for sign in (-1.0, 1.0)]
        grown[place] = max(1.0, float(np.sqrt(np.mean(np.square(sides)))))
    return replace(fit, covariance=fit.covariance * np.outer(grown, grown))


def _single(fit: Fit) -> Iterator[tuple[int, Hypothesis]]:
    """Causes of one parameter, with the place of it among the sizes."""
    start = 0
    for cause in fit.causes:
        if len(cause.parameters) == 1:
            yield start, cause
        start += len(cause.parameters)


def _side(evidence: Evidence, fit: Fit, others: Causes, place: int, sd: float) -> float:
    """How many of these standard deviations the profile has on one side."""
    distance, width = AT, 1.0
    for _ in range(DOUBLED):
        rise = _held(evidence, fit, others, place, distance * sd) - fit.chi2
        width = distance / np.sqrt(max(rise, RISE))
        if rise >= RISE:
            break
        distance *= 2.0
    return float(width)


def _held(evidence: Evidence, fit: Fit, others: Causes, place: int, off: float) -> float:
    """The least chi^2 with one size held: from the fit, and from no commissioning error at all.

    Beside the fit columns may be so bent that a search from there ends on its slope.
    """
    runs = fit.local.runs
    at = fit.active[place]
    starts: list[FloatArray] = [fit.shift, np.where(runs.sd > 0.0, 0.0, fit.shift)]
    found = []
    for start in starts:
        shift = np.clip(start, runs.low, runs.high)
        shift[at] = np.clip(fit.shift[at] + off, runs.low[at], runs.high[at])
        found.append(refine(evidence, others, shift, fit.local, 1, fit.step_share).chi2)
    return min(found)
