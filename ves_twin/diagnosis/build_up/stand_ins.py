"""StandIns: which other causes do as well as a proved one in its place."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.build_up.bench import Bench
from ves_twin.diagnosis.build_up.paired import loss
from ves_twin.diagnosis.build_up.proof import Proof
from ves_twin.diagnosis.build_up.regression import Regression

TRIED = 12
"""Causes by falling gain that are tried in the place of each proved one."""

SIGNIFICANT = 0.05
"""p below which a stand-in is clearly worse."""

HALF = 0.5
"""Share of a cause's own improvement that a stand-in may lose, where the test is too weak."""

LEAST = 4.0
"""Chi^2 that a stand-in must take at all on the fitted half."""


FAR = 10.0
"""Times its range beyond which a cause is none of this machine, and stands in for nothing: assumed.
A constant torque of a rotor was 4 times what its efforts at work had suggested."""


@dataclass(frozen=True)
class StandIns:
    """Of each proved trial those that held-out rows cannot tell from it, by falling likeness.

    Attributes:
        within: trials whose size there is within its range.
        beyond: trials that would need a size beyond it, and that size (parameters,).
    """

    within: Mapping[int, list[int]]
    beyond: Mapping[int, Mapping[int, FloatArray]]

    @staticmethod
    def of(proof: Proof) -> StandIns:
        """Each one in turn in the place of each proved one, all others refitted."""
        regression = proof.bench.regression
        trials, kept = regression.trials, list(proof.proved)
        others = regression.rest(kept)
        judges = proof.judges.fitted(kept)
        within: dict[int, list[int]] = {}
        beyond: dict[int, dict[int, FloatArray]] = {}
        for n in kept:
            bench, within[n], beyond[n] = judges.of_trial(n), [], {}
            good = dict(_as_good(proof, bench, n, others))
            known = set[str]()  # of trials of one cause the likeliest
            for short in (False, True):
                for k, shares in good.items():
                    label = trials[k].cause.label
                    if label in known or regression.impossible(k, shares) != short:
                        continue
                    if not short:
                        within[n].append(k)
                    elif _is_short(regression, k, shares):
                        beyond[n][k] = trials[k].departures(shares * regression.prior[k])
                    else:
                        continue
                    known.add(label)
        return StandIns(within, beyond)


def _as_good(
    proof: Proof, bench: Bench, trial: int, others: Sequence[int]
) -> Iterator[tuple[int, FloatArray]]:
    """Others that do as well in a trial's place, with their amplitudes [prior sd]."""
    regression, kept = bench.regression, list(proof.proved)
    rest, whitening = [k for k in kept if k != trial], bench.fit.whitening
    scale = bench.scale(kept)
    beside = loss(bench.innovations(kept), scale)
    likely = _likely(bench, rest, others)
    wider = replace(bench, fit=regression.solve([*kept, *likely], whitening))
    for k in likely:
        shares = regression.solve([*rest, k], whitening).shares
        told = wider.compared(trial, loss(wider.innovations([*rest, k]), scale), beside)
        if told.p > SIGNIFICANT and told.total < HALF * proof.differences[trial].total:
            yield k, np.asarray(shares[regression.places([*rest, k])[k]])


def _is_short(regression: Regression, trial: int, shares: FloatArray) -> bool:
    """Whether the range of a cause that nobody commissions is too narrow, and its sign is right."""
    runs, (low, high) = regression.half.runs, regression.limits[trial]
    known = runs.sd[runs.indices(regression.trials[trial].cause)] > 0.0
    near = np.all(shares >= FAR * low) and np.all(shares <= FAR * high)
    return bool(near) and not np.any(known)


def _likely(bench: Bench, rest: Sequence[int], others: Sequence[int]) -> list[int]:
    """Those that take most on the fitted half beside the rest."""
    if not others:
        return []
    fit = bench.regression.solve(rest, bench.fit.whitening)
    gains = bench.regression.gains(fit, others)
    ranked = sorted(others, key=gains.of, reverse=True)[:TRIED]
    likely = [n for n in ranked if gains.of(n) > LEAST]
    failed = bench.held.columns.failed(likely)
    return [n for n in likely if n not in failed]
