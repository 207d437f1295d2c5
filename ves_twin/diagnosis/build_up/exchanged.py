"""exchanged: a proof with other trials in the place of some, where all of it is proved."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from ves_twin.diagnosis.build_up.proof import Proof, prove


def exchanged(proof: Proof, others: Mapping[int, int]) -> Proof:
    """The proof with other trials in the place of some; the same where not all of it is proved.

    What was tried counts for the false-discovery rate either way.

    Args:
        proof: what is proved.
        others: trial of it -> the one that takes its place.
    """
    bench = proof.bench
    names = [others.get(n, n) for n in proof.proved]
    new = sum(n not in proof.dropped for n in others.values())  # the rest was put to proof
    more = proof.tested - len(names) + new
    judges = proof.judges
    for trial, other in others.items():
        judges = judges.like(trial, other, names)
    tried = prove(bench.regression, bench.held, names, more, judges)
    if set(tried.proved) != set(names):
        return replace(proof, tested=tried.tested)
    dropped = {n: p for n, p in proof.dropped.items() if n not in others.values()}
    return replace(tried, dropped={**dropped, **tried.dropped})
