"""spanned_by: few other causes whose columns together do what a proved one does."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np

from ves_twin.core.types import FloatArray, IntArray
from ves_twin.diagnosis.build_up.bench import Bench
from ves_twin.diagnosis.build_up.proof import Proof

MOST = 3
"""Causes that are tried together: viscous friction on the sum of two speeds is that of each joint,
less that on their difference."""

NEAREST = 24
"""Causes, by how much of the column each spans alone, of which combinations are tried: all that
act at two joints of an arm with a dozen kinds, and 2 300 combinations."""


def spanned_by(proof: Proof, trial: int) -> tuple[int, ...]:
    """The fewest others beside which a proved trial would be pruned; none where nothing spans it.

    With its column x cleared of all other proved trials and of nuisances, and its amplitude a, what
    the columns Z of others leave of it is a' (x'x - x'Z (Z'Z)^-1 Z'x) a of chi^2, whitened by the
    discrepancy. Less than ln n a column is no more than the Bayesian criterion asks. Only others
    that act where it acts count: anything spans a record of six joints.

    Args:
        proof: what is proved.
        trial: one of it.
    """
    regression = proof.bench.regression
    kept = list(proof.proved)
    whitening = proof.bench.fit.whitening
    if not np.any(whitening.filters[..., 1:]):  # rows of slow errors are not independent
        whitening = regression.fit(kept).whitening
    fit = regression.solve(kept, whitening)
    bench = replace(proof.bench, fit=fit)
    others = _others(bench, kept, trial)
    if not others:
        return ()
    without = regression.solve([n for n in kept if n != trial], fit.whitening)
    gains = regression.gains(without, [trial, *others])
    shares = fit.shares[regression.places(kept)[trial]]
    own = gains.where[trial]
    limit = len(own) * float(np.log(fit.samples))
    matrix = gains.gram + np.eye(len(gains.gram))
    alone = {n: _left(gains.gram, matrix, own, gains.where[n], shares) for n in others}
    near = sorted(others, key=lambda n: alone[n])[:NEAREST]
    for count in range(1, MOST + 1):
        tried = [
            few
            for few in combinations(near, count)
            if len({regression.trials[n].cause.label for n in few}) == count
        ]
        left = [
            _left(gains.gram, matrix, own, np.concatenate([gains.where[n] for n in few]), shares)
            for few in tried
        ]
        if left and min(left) < limit:
            return tried[int(np.argmin(left))]
    return ()


def _others(bench: Bench, kept: list[int], trial: int) -> list[int]:
    """Trials of causes that are not proved, and act on no channel where this one does not."""
    trials = bench.regression.trials
    used, acts = {trials[n].cause.label for n in kept}, bench.acts(trial)
    return [
        n
        for n, one in enumerate(trials)
        if one.cause.label not in used and not np.any(bench.acts(n) & ~acts)
    ]


def _left(
    gram: FloatArray, matrix: FloatArray, own: IntArray, at: IntArray, shares: FloatArray
) -> float:
    """Chi^2 of a trial that others leave."""
    cross = gram[np.ix_(at, own)]
    rest = gram[np.ix_(own, own)] - cross.T @ np.linalg.solve(matrix[np.ix_(at, at)], cross)
    return float(shares @ rest @ shares)
