"""score_challenges: a policy on sealed rigs, a set for each challenge of real machines."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from ves_twin.envs.evaluation import NO_RIGS, Evaluation, Trial, evaluate

CHALLENGES = {
    "none": NO_RIGS,
    "delay": "delay-v0",
    "noise": "noise-v0",
    "fault seen": "train-v0",
    "fault unseen": "unseen-v0",
    "two faults": "two-v0",
    "drift": "drift-v0",
    "limits": "limits-v0",
}
"""Challenge -> set of rigs. After Dulac-Arnold et al., Machine Learning 110, 2021: delays,
noise, perturbed systems, unspecified faults, limits. Those that concern rewards are left out."""


@dataclass(frozen=True)
class Row:
    """A challenge and what a policy scored on its rigs."""

    challenge: str
    evaluation: Evaluation


def score_challenges(
    trial: Trial,
    seeds: Sequence[int],
    workers: int = 1,
    progress: Callable[[float, str], None] = lambda share, what: None,
) -> tuple[Row, ...]:
    """Run an episode for each challenge and seed; a seed fixes rig, goal and noise.

    Args:
        trial: environment, policy and plant; its rigs are those of the challenges.
        seeds: at least one.
        workers: processes.
        progress: called with the share done and the challenge.

    Raises:
        VesTwinError: as `evaluate`.
    """
    rows: list[Row] = []
    for name, rigs in CHALLENGES.items():

        def show(share: float, name: str = name) -> None:
            progress((len(rows) + share) / len(CHALLENGES), name)

        found = evaluate(replace(trial, rigs=rigs), seeds, workers, show)
        rows.append(Row(name, found))
    return tuple(rows)
