"""stand_ins: which other causes do as well as a proved one in its place."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ves_twin.diagnosis.build_up.bench import Bench
from ves_twin.diagnosis.build_up.paired import loss
from ves_twin.diagnosis.build_up.proof import Proof

TRIED = 12
"""Causes by falling gain that are tried in the place of each proved one."""

SIGNIFICANT = 0.05
"""p below which a stand-in is clearly worse."""

HALF = 0.5
"""Share of a cause's own improvement that a stand-in may lose, where the test is too weak."""

LEAST = 4.0
"""Chi^2 that a stand-in must take at all on the fitted half."""


def stand_ins(proof: Proof) -> dict[int, list[int]]:
    """Of each proved trial those that held-out rows cannot tell from it, by falling likeness."""
    regression = proof.bench.regression
    trials, kept = regression.trials, list(proof.proved)
    others = regression.rest(kept)
    judges = proof.judges.fitted(kept)
    found: dict[int, list[int]] = {}
    for n in kept:
        bench, rest = judges.of_trial(n), [k for k in kept if k != n]
        scale, whitening = bench.scale(kept), bench.fit.whitening
        beside = loss(bench.innovations(kept), scale)
        likely = _likely(bench, rest, others)
        wider = replace(bench, fit=regression.solve([*kept, *likely], whitening))
        found[n] = []
        for k in likely:
            if trials[k].cause.label in {trials[m].cause.label for m in found[n]}:
                continue
            alone = regression.solve([*rest, k], whitening)
            if regression.impossible(k, alone.shares[regression.places([*rest, k])[k]]):
                continue
            worse = loss(wider.innovations([*rest, k]), scale)
            told = wider.compared(n, worse, beside)
            if told.p > SIGNIFICANT and told.total < HALF * proof.differences[n].total:
                found[n].append(k)
    return found


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
