"""next_of_kin: a proof in which what was dropped leaves its place to another cause at its place."""

from __future__ import annotations

from dataclasses import replace

from ves_twin.diagnosis.build_up.proof import Proof, prove
from ves_twin.diagnosis.build_up.stand_ins import HALF, LEAST


def next_of_kin(proof: Proof) -> Proof:
    """The proof with other causes at the places of dropped ones, where those are proved.

    A choice on the fitted half takes one of several causes that look alike there. Where held-out
    rows do not bear it out, its like may be what is there: viscous friction of a satellite's wheel
    failed in the place of Coulomb friction. One other is tried for each, the one that takes most
    of the fitted half beside what is proved, and it counts for the rate.
    """
    told, bench = proof, proof.bench
    for n in sorted(proof.dropped, key=lambda one: proof.dropped[one]):
        other = _likest(told, n)
        if other is None:
            continue
        names, more = [*told.proved, other], told.tested - len(told.proved)
        tried = prove(bench.regression, bench.held, names, more, bench.errors)
        if set(tried.proved) == set(names):
            told = replace(tried, dropped={**told.dropped, **tried.dropped})
            continue
        p = tried.dropped[other] if other in tried.dropped else tried.differences[other].p
        told = replace(told, tested=tried.tested, dropped={**told.dropped, other: p})
    return told


def _likest(proof: Proof, dropped: int) -> int | None:
    """Of other causes at its target the one that takes most, half as much as it did or more."""
    regression = proof.bench.regression
    trials, tried = regression.trials, {*proof.proved, *proof.dropped}
    known, target = {trials[n].cause.label for n in tried}, trials[dropped].cause.target
    others = [
        k
        for k in regression.rest(list(proof.proved))
        if trials[k].cause.target == target and trials[k].cause.label not in known
    ]
    if not others:
        return None
    fit = regression.solve(proof.proved, proof.bench.fit.whitening)
    gains = regression.gains(fit, [dropped, *others])
    least = max(LEAST, HALF * gains.of(dropped))
    failed = proof.bench.held.columns.failed(others)
    sound = [k for k in others if k not in failed and gains.of(k) > least]
    return max(sound, key=gains.of, default=None)
