"""best_proved: of some choices of causes the one of which what is proved predicts best."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.build_up.halves import Halves
from ves_twin.diagnosis.build_up.offer import least_left
from ves_twin.diagnosis.build_up.proof import prove


def best_proved(
    halves: Halves, sets: Sequence[Sequence[int]], known: frozenset[str]
) -> tuple[list[int], frozenset[str]]:
    """What is proved of the choice of which it predicts held-out rows best.

    Where model error is a law of the motion, a long choice describes the fitted half: its causes
    mimic each other on held-out rows, and the proof, which drops one after the other, may end
    without the two that are there (a double pendulum by sweeps: fourteen, none proved, where the
    frictions of both joints are proved alone).

    Args:
        halves: linear about a point.
        sets: choices, each a few trials.
        known: labels of the causes that were put to proof before.

    Returns:
        Its trials, and the labels with those of that choice; none where nothing is proved.
    """
    regression, held = halves.regression, halves.held
    found, left = list[tuple[list[int], frozenset[str]]](), list[FloatArray]()
    for chosen in dict.fromkeys(tuple(some) for some in sets if some):
        labels = frozenset(regression.trials[n].cause.label for n in chosen)
        proof = prove(regression, held, chosen, more=len(known - labels))
        if proof.proved:
            fit = regression.solve(proof.proved, proof.bench.fit.whitening)
            found.append((list(proof.proved), known | labels))
            left.append(replace(proof.bench, fit=fit).residual(proof.proved))
    return found[least_left(held, regression.quietest, left)] if found else ([], known)
