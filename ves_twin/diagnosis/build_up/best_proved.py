"""best_proved, most_promising: of some choices of causes the one that is proved to predict best."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.build_up.halves import Halves
from ves_twin.diagnosis.build_up.offer import least_left
from ves_twin.diagnosis.build_up.weighed import weighed


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
    best = _best(halves, sets, known)
    return best[1:] if best else ([], known)


def most_promising(halves: Halves, sets: Sequence[Sequence[int]], known: frozenset[str]) -> int:
    """The same set by its number; the first one where nothing is proved of any."""
    best = _best(halves, sets, known)
    return best[0] if best else 0


def _best(
    halves: Halves, sets: Sequence[Sequence[int]], known: frozenset[str]
) -> tuple[int, list[int], frozenset[str]] | None:
    """Its number, what is proved of it, and the labels with its own; None where nothing is."""
    regression, held = halves.regression, halves.held
    found, left = list[tuple[int, list[int], frozenset[str]]](), list[FloatArray]()
    numbers = {tuple(some): n for n, some in reversed(list(enumerate(sets))) if some}
    for chosen, number in sorted(numbers.items(), key=lambda item: item[1]):
        labels = frozenset(regression.trials[n].cause.label for n in chosen)
        proof = weighed(regression, held, chosen, len(known - labels))
        if proof.proved:
            fit = regression.solve(proof.proved, proof.bench.fit.whitening)
            found.append((number, list(proof.proved), known | labels))
            left.append(replace(proof.bench, fit=fit).residual(proof.proved))
    return found[least_left(held, regression.quietest, left)] if found else None
