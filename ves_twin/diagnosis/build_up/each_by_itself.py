"""each_by_itself: a proof in which two couplings of the same joints are the friction of each."""

from __future__ import annotations

from itertools import combinations, product

import numpy as np

from ves_twin.diagnosis.build_up.exchanged import exchanged
from ves_twin.diagnosis.build_up.paired import loss
from ves_twin.diagnosis.build_up.plain_selector import USUAL
from ves_twin.diagnosis.build_up.proof import Proof
from ves_twin.diagnosis.build_up.stand_ins import SIGNIFICANT

WORSE = 0.1
"""Share of what both couplings improve on held-out rows that they may be better by."""


def each_by_itself(proof: Proof) -> Proof:
    """The proof with two frictions of single joints for two couplings that do no more.

    Viscous friction c1 on the sum of two speeds and c2 on their difference is (c1 + c2) at each
    joint, and (c1 - c2) from each to the other: with c1 = c2 there is no coupling. Two frictions
    are as many numbers. They must predict held-out rows as well, and be proved as everything is.
    """
    told = proof
    for one, two in combinations(proof.proved, 2):
        if one in told.proved and two in told.proved and _alike(told, one, two):
            for pair in _single(told, one, two):
                told = exchanged(told, dict(zip((one, two), pair, strict=True)))
                if one not in told.proved:
                    break
    return told


def _alike(proof: Proof, one: int, two: int) -> bool:
    """Whether two trials are of one kind that is not usual, and act on the same two channels."""
    trials, bench = proof.bench.regression.trials, proof.bench
    kinds = {trials[n].cause.effect for n in (one, two)}
    acts = bench.acts(one)
    same = bool(np.array_equal(acts, bench.acts(two)))
    return len(kinds) == 1 and not kinds & {*USUAL} and same and int(acts.sum()) == 2


def _single(proof: Proof, one: int, two: int) -> list[tuple[int, int]]:
    """Pairs of usual frictions, one on each of two channels, that do as well; the best first."""
    regression, kept = proof.bench.regression, list(proof.proved)
    trials, bench = regression.trials, proof.bench
    known = {trials[n].cause.label for n in kept}
    at: dict[int, list[int]] = {int(c): [] for c in np.flatnonzero(bench.acts(one))}
    for n in regression.rest(kept):
        cause, acts = trials[n].cause, bench.acts(n)
        channel = int(np.argmax(acts))
        if cause.effect in USUAL and cause.label not in known and acts.sum() == 1 and channel in at:
            at[channel].append(n)
    failed = bench.held.columns.failed([n for some in at.values() for n in some])
    at = {channel: [n for n in some if n not in failed] for channel, some in at.items()}
    pairs = [
        (a, b) for a, b in product(*at.values()) if trials[a].cause.effect == trials[b].cause.effect
    ]
    if not pairs:
        return []
    others = sorted({n for pair in pairs for n in pair})
    judge = proof.judges.fitted([*kept, *others]).of_trial(one)
    rest, scale = [n for n in kept if n not in (one, two)], judge.scale(kept)
    beside = loss(judge.innovations(kept), scale)
    limit = WORSE * sum(proof.differences[n].total for n in (one, two))
    worse = {}
    for pair in pairs:
        found = judge.compared(one, loss(judge.innovations([*rest, *pair]), scale), beside)
        worse[pair] = found.total if found.p > SIGNIFICANT else float("inf")
    return sorted((pair for pair in pairs if worse[pair] <= limit), key=lambda pair: worse[pair])
