"""exchanged: a proof with another trial in the place of one, where all of it is proved."""

from __future__ import annotations

from dataclasses import replace

from ves_twin.diagnosis.build_up.proof import Proof, prove


def exchanged(proof: Proof, trial: int, other: int) -> Proof:
    """The proof with another trial in the place of one; the same where not all of that is proved.

    What was tried counts for the false-discovery rate either way.

    Args:
        proof: what is proved.
        trial: one of it.
        other: that takes its place.
    """
    bench = proof.bench
    names = [other if n == trial else n for n in proof.proved]
    new = other not in proof.dropped  # the others were put to proof
    more = proof.tested - len(names) + new
    judges = proof.judges.like(trial, other, names)
    tried = prove(bench.regression, bench.held, names, more, judges)
    if set(tried.proved) != set(names):
        return replace(proof, tested=tried.tested)
    dropped = {n: p for n, p in proof.dropped.items() if n != other}
    return replace(tried, dropped={**dropped, **tried.dropped})
