"""probe: a Jacobian put right along the directions in which a fit knows its causes least."""

from __future__ import annotations

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.search import Point, Search

REACH = 6.0
"""Sd to either side of the fit that are simulated: what sticks and slips by chance, some 5 sigma,
is then below one sd."""

LEAST_REACH = 0.3
"""Sd that bounds must leave room for."""

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
    J becomes J + (d - J v) v' / v'v, until |d|^2 + v' priors v is the 1 that it is by J.

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
            direction = covariance[:, n] / np.sqrt(covariance[n, n])
            seen = _change(search, point, jacobian, direction)
            if seen is None:
                break
            jacobian = jacobian + _secant(search, jacobian, direction, seen)
            errors = direction[len(search.free) :]
            if abs(float(seen @ seen + errors @ errors) - 1.0) < TRUE:
                break
    return jacobian


def _change(
    search: Search, point: Point, jacobian: FloatArray, direction: FloatArray
) -> FloatArray | None:
    """Whitened change along a direction, for one of it; None where bounds leave no room."""
    axes = np.concatenate([search.free, search.nuisances])
    move = (direction * search.unit)[:-1]
    here = point.shift[axes]
    room = np.minimum(search.high[axes] - here, here - search.low[axes])
    reach = float(np.min(room / np.maximum(np.abs(move), 1e-300), initial=REACH))
    if reach < LEAST_REACH:
        return None
    ends = []
    for share in (reach, -reach):
        shift = point.shift.copy()
        shift[axes] += share * move
        ends.append(search.runs.one(shift))
    if not np.all(np.isfinite(ends)):
        return None
    change = search.evidence.whitening.apply(ends[0] - ends[1]) / (2.0 * reach)
    return np.asarray(change + jacobian[:, -1] * direction[-1])


def _secant(
    search: Search, jacobian: FloatArray, direction: FloatArray, seen: FloatArray
) -> FloatArray:
    """What makes the columns agree with a change; those that are known stay as they are.

    What zeroing leaves differs by chance between two runs, so the surprise is taken without it.
    """
    known = len(search.free) + search.known
    surprise = seen - jacobian @ direction
    basis = jacobian[:, known]
    surprise = surprise - basis @ (search.solved @ (basis.T @ surprise))
    turning = direction.copy()
    turning[known] = 0.0
    return np.outer(surprise, turning) / max(float(turning @ turning), 1e-30)
