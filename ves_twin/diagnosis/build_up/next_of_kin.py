"""next_of_kin: a proof in which what was dropped leaves its place to another cause at its place."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from ves_twin.diagnosis.build_up.proof import NULL_FROM, Proof, prove
from ves_twin.diagnosis.build_up.stand_ins import HALF, LEAST

MOST = 3
"""Others that are tried in the place of one: each that fails costs the rest a share of the rate."""


def next_of_kin(proof: Proof) -> Proof:
    """The proof with other causes at the places of dropped ones, where those are proved.

    A choice on the fitted half takes one of several causes that look alike there. Where held-out
    rows do not bear it out, its like may be what is there: viscous friction of a satellite's wheel
    failed in the place of Coulomb friction. Those are tried that take most of the fitted half
    beside what is proved, until one is proved, and each counts for the rate if one is; none in the
    place of what held-out rows speak against.
    """
    told, in_vain = proof, dict[int, float]()
    likely = [n for n, p in proof.dropped.items() if p <= NULL_FROM]
    for n in sorted(likely, key=lambda one: proof.dropped[one]):
        for other in _likest(told, n):
            tried = _beside(told, n, other, in_vain)
            if other in tried.proved and len(tried.proved) > len(told.proved):
                told, in_vain = tried, {}
                break
            found = tried.differences
            in_vain[other] = found[other].p if other in tried.proved else tried.dropped[other]
    return told


def _beside(proof: Proof, dropped: int, other: int, in_vain: Mapping[int, float]) -> Proof:
    """The proof with another trial beside all of it, those before it tried in vain."""
    bench, names = proof.bench, [*proof.proved, other]
    more = proof.tested - len(proof.proved) + len(in_vain)
    judges = proof.judges.like(dropped, other, names)
    tried = prove(bench.regression, bench.held, names, more, judges)
    return replace(tried, dropped={**proof.dropped, **in_vain, **tried.dropped})


def _likest(proof: Proof, dropped: int) -> list[int]:
    """Of other causes at its target those that take most, half as much as it did or more."""
    regression = proof.bench.regression
    trials, tried = regression.trials, {*proof.proved, *proof.dropped}
    known, target = {trials[n].cause.label for n in tried}, trials[dropped].cause.target
    others = [
        k
        for k in regression.rest(list(proof.proved))
        if trials[k].cause.target == target and trials[k].cause.label not in known
    ]
    if not others:
        return []
    fit = regression.solve(proof.proved, proof.bench.fit.whitening)
    gains = regression.gains(fit, [dropped, *others])
    least = max(LEAST, HALF * gains.of(dropped))
    failed = proof.bench.held.columns.failed(others)
    sound = [k for k in others if k not in failed and gains.of(k) > least]
    best: dict[str, int] = {}
    for k in sorted(sound, key=gains.of, reverse=True):
        best.setdefault(trials[k].cause.label, k)
    return list(best.values())[:MOST]
