"""probe: a Jacobian put right along the directions in which a fit knows its causes least."""

from __future__ import annotations

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.fit.search import Point, Search

REACH = 6.0
"""Sd to either side of the fit that are simulated: what sticks and slips by chance, some 5 sigma,
is then below one sd."""

LEAST = 0.05
"""Share of its way that bounds must leave to the parameter itself."""

PROBES = 6
"""Directions at most that are tried for each parameter of a cause."""

TRUE = 0.1
"""Relative error of a curvature that moves an interval by no more than a twentieth."""


def probe(search: Search, point: Point, jacobian: FloatArray) -> FloatArray:
    """The Jacobian at a fit, turned until it foretells what its least known directions do.

    Columns are differences over finite moves. Where several parameters together leave the record
    as it is (forces and masses of one share), J v should vanish, but the columns' errors do not
    cancel: they pass for information, and the fit stops short of where the priors would have it.
    So for each parameter of a cause the direction along which it varies, v = S e / sqrt(e'S e)
    with S = (J'J + priors)^-1, is simulated to either side, d = (f(x + t v) - f(x - t v)) / 2t;
    J becomes J + (d - J v) v' / v'v, until |d|^2 is what it is by J, of the 1 that it is with the
    priors' part, v being as much of it as bounds let.

    Args:
        search: whose evidence, axes and units count.
        point: the most probable point by the Jacobian as it is.
        jacobian: whitened columns in the search's units.

    Source: Broyden 1965, the good update, along directions chosen by the fit's own covariance.
    """
    for n in range(len(search.free)):
        for _ in range(PROBES):
            covariance = np.linalg.pinv(search.hessian(jacobian), hermitian=True)
            if not covariance[n, n] > 0.0:  # nothing shows it, as a limit that nothing reaches
                break
            found = _change(search, point, covariance[:, n] / np.sqrt(covariance[n, n]))
            if found is None or abs(found[0][n]) < LEAST * np.sqrt(covariance[n, n]):
                break
            direction, seen = found
            seen = seen + jacobian[:, -1] * direction[-1]
            told, prior = jacobian @ direction, np.sum(direction[len(search.free) :] ** 2)
            jacobian = jacobian + _secant(search, direction, seen - told)
            if abs(seen @ seen - told @ told) < TRUE * (told @ told + prior):
                break
    return jacobian


def _change(
    search: Search, point: Point, asked: FloatArray
) -> tuple[FloatArray, FloatArray] | None:
    """Direction as far as bounds let, and whitened change along it; None where the plant fails.

    What stands at a bound, as a leak that is not there, moves to one side.
    """
    axes = np.concatenate([search.free, search.nuisances])
    ends, stacks = [], []
    for share in (REACH, -REACH):
        shift = point.shift.copy()
        shift[axes] += share * (asked * search.unit)[:-1]
        ends.append(np.clip(shift, search.low, search.high))
        stacks.append(search.runs.one(ends[-1]))
    if not np.all(np.isfinite(stacks)):
        return None
    moved = (ends[0] - ends[1])[axes] / search.unit[:-1] / (2.0 * REACH)
    change = search.evidence.whitening.apply(stacks[0] - stacks[1]) / (2.0 * REACH)
    return np.append(moved, asked[-1]), np.asarray(change)


def _secant(search: Search, direction: FloatArray, surprise: FloatArray) -> FloatArray:
    """What makes the columns agree with a change; those that are known stay as they are.

    What zeroing leaves differs by chance between two runs, so the surprise is taken without it.
    """
    known = len(search.free) + search.known
    basis = search.columns[:, search.known]
    surprise = surprise - basis @ (search.solved @ (basis.T @ surprise))
    turning = direction.copy()
    turning[known] = 0.0
    return np.outer(surprise, turning) / max(float(turning @ turning), 1e-30)
