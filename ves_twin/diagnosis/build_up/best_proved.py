"""best_proved, promising: of some choices of causes the one that is proved to predict best."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.build_up.halves import Halves
from ves_twin.diagnosis.build_up.offer import left_of
from ves_twin.diagnosis.build_up.weighed import weighed

BEHIND = 50.0
"""Nats by which a choice may leave more of held-out rows than the best, and be fitted in full all
the same. On TX40 124 became 149 by full fits that cost a third of a round, on the seven-axis arm 12
became 11: from 20 to 120 all decide alike on both."""


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
    found = [one for one in _each(halves, [*filter(None, sets)], known) if one.proved]
    if not found:
        return [], known
    best = found[int(np.argmin(_left_of(halves, found)))]
    return list(best.proved), best.labels


def promising(halves: Halves, sets: Sequence[Sequence[int]], known: frozenset[str]) -> list[int]:
    """Which choices are worth a full fit, by their numbers, the one that promises most first.

    By what held-out rows have left where all that is proved of it is at work, linear about the
    point. A choice that leaves BEHIND more than the best is none, nor the same one twice.

    Args:
        halves: linear about a point.
        sets: choices, one at least, each a few trials.
        known: labels of the causes that were put to proof before.
    """
    found = _each(halves, sets, known)
    left = _left_of(halves, found)
    ranked = sorted(zip(left, (one.number for one in found), strict=True))
    near = [n for one, n in ranked if one <= min(left) + BEHIND]
    return list({frozenset(sets[n]): n for n in reversed(near)}.values())[::-1]


@dataclass(frozen=True)
class _Promise:
    """What is proved of a choice, linear about a point.

    Attributes:
        number: of the choice.
        proved: its trials.
        labels: of all that was put to proof.
        left: of held-out rows (rows, c).
    """

    number: int
    proved: tuple[int, ...]
    labels: frozenset[str]
    left: FloatArray


def _each(halves: Halves, sets: Sequence[Sequence[int]], known: frozenset[str]) -> list[_Promise]:
    """Of each different choice."""
    regression, held, found = halves.regression, halves.held, list[_Promise]()
    numbers = {tuple(some): n for n, some in reversed(list(enumerate(sets)))}
    for chosen, number in sorted(numbers.items(), key=lambda item: item[1]):
        labels = frozenset(regression.trials[n].cause.label for n in chosen)
        proof = weighed(regression, held, chosen, len(known - labels))
        fit = regression.solve(proof.proved, proof.bench.fit.whitening)
        left = replace(proof.bench, fit=fit).residual(proof.proved)
        found.append(_Promise(number, tuple(proof.proved), known | labels, left))
    return found


def _left_of(halves: Halves, found: Sequence[_Promise]) -> list[float]:
    """What each leaves of held-out rows, see `left_of`."""
    quietest = halves.regression.quietest
    return [float(x) for x in left_of(halves.held, quietest, [one.left for one in found])]
