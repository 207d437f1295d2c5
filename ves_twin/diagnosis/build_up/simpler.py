"""simpler: a proof in which each cause is the simplest that predicts as well at its place."""

from __future__ import annotations

from collections.abc import Sequence

from ves_twin.diagnosis.build_up.bench import Bench
from ves_twin.diagnosis.build_up.exchanged import exchanged
from ves_twin.diagnosis.build_up.paired import loss
from ves_twin.diagnosis.build_up.plain_selector import USUAL
from ves_twin.diagnosis.build_up.proof import Proof
from ves_twin.diagnosis.build_up.stand_ins import SIGNIFICANT
from ves_twin.diagnosis.model.forward import Hypothesis

INEFFECTIVE = 0.1
"""Share of a cause's held-out improvement up to which further numbers are worth none."""


def simpler(proof: Proof) -> Proof:
    """The proof with the simplest cause at each place that predicts as well as the proved one.

    Stribeck friction that falls beyond the speeds of a record is Coulomb friction. Of as many
    numbers a friction that every machine has is the simpler one: where a motor turns one way alone,
    viscous friction that differs by direction is viscous friction. What the further
    numbers of a cause improve on held-out rows must be clear of zero, or more than INEFFECTIVE of
    the whole; and all that takes its place must be proved as everything is.
    """
    told = proof
    for n in proof.proved:
        for other in _fewer(told, n):
            told = exchanged(told, {n: other})
            if other in told.proved:
                break
    return told


def _fewer(proof: Proof, trial: int) -> list[int]:
    """Trials of simpler causes at the same place that do as well, the best first."""
    regression = proof.bench.regression
    trials, kept = regression.trials, list(proof.proved)
    cause = trials[trial].cause
    others = [
        k
        for k in regression.rest(kept)
        if trials[k].cause.target == cause.target and _is_simpler(trials[k].cause, cause)
    ]
    failed = proof.bench.held.columns.failed(others)  # of held-out motion that goes farther
    others = [k for k in others if k not in failed]
    if not others:
        return []
    rest = [k for k in kept if k != trial]
    bench = proof.judges.fitted([*kept, *others]).of_trial(trial)
    worse = {k: _worse(bench, rest, trial, k) for k in others}
    limit = INEFFECTIVE * proof.differences[trial].total
    return sorted((k for k in others if worse[k] <= limit), key=lambda k: worse[k])


def _is_simpler(one: Hypothesis, other: Hypothesis) -> bool:
    """Whether a cause has fewer numbers than another, or as many and is a usual friction."""
    numbers, others = len(one.parameters), len(other.parameters)
    usual = one.effect in USUAL and other.effect not in USUAL
    return numbers < others or (numbers == others and usual)


def _worse(bench: Bench, rest: Sequence[int], trial: int, other: int) -> float:
    """What held-out rows lose by another trial in the place of one; infinite if that is clear."""
    scale = bench.scale([*rest, trial])
    losses = [loss(bench.innovations([*rest, k]), scale) for k in (other, trial)]
    told = bench.compared(trial, *losses)
    return told.total if told.p > SIGNIFICANT else float("inf")
