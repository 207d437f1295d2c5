"""Question and separation: which causes are to be told apart, and by how much a programme does."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.types import FloatArray, IntArray
from ves_twin.diagnosis.bank.linearise import Linearisation
from ves_twin.diagnosis.bank.metric import Metric
from ves_twin.diagnosis.model.forward import Forward, Hypothesis
from ves_twin.diagnosis.record.whitening import whitening_declared

Axes = tuple[IntArray, FloatArray]
"""Coordinates and the sd of each."""


@dataclass(frozen=True)
class Question:
    """Which causes are to be told apart.

    Attributes:
        causes: the causes.
        pairs: numbers of two of them each.
    """

    causes: tuple[Hypothesis, ...]
    pairs: tuple[tuple[int, int], ...]

    @staticmethod
    def of(forward: Forward, names: Sequence[str]) -> Question:
        """Every cause of a name against every cause of another one.

        Args:
            forward: whose library has them.
            names: two or more, each a kind, or kind@target.

        Raises:
            UnknownNameError: no such cause; says the nearest one.
            InvalidInputError: fewer than two causes.
        """
        groups = [_named(forward, name) for name in names]
        return Question.of_pairs(
            [(a, b) for one, two in combinations(groups, 2) for a in one for b in two],
            "/".join(names),
        )

    @staticmethod
    def of_pairs(pairs: Sequence[tuple[Hypothesis, Hypothesis]], said: str) -> Question:
        """Pairs of causes, each once.

        Args:
            pairs: in any order.
            said: what was asked for.

        Raises:
            InvalidInputError: no two different causes.
        """
        apart = [pair for pair in pairs if pair[0].label != pair[1].label]
        if not apart:
            raise InvalidInputError("causes to tell apart", said, "two different ones: A/B")
        causes = {cause.label: cause for pair in apart for cause in pair}
        place = {label: k for k, label in enumerate(causes)}
        numbers = {tuple(sorted((place[a.label], place[b.label]))) for a, b in apart}
        return Question(tuple(causes.values()), tuple(sorted((i, j) for i, j in numbers)))

    def least(self, apart: FloatArray) -> FloatArray:
        """Chi^2 by which each pair is parted, the lesser of its two orders (pairs,)."""
        return np.array([min(apart[i, j], apart[j, i]) for i, j in self.pairs])


def size_of(cause: Hypothesis) -> FloatArray:
    """Its smallest size in a bank (parameters,): larger ones bend, and what bends seems apart.

    What a large cause changes beyond proportion is no column of any tolerance, yet a fit that
    moves the tolerances themselves would explain it.
    """
    sizes = cause.departures()
    side = sizes[np.all(sizes * cause.signs[-1] >= 0.0, axis=1)]
    return np.asarray(side[0] if len(side) else sizes[0])


def _named(forward: Forward, name: str) -> list[Hypothesis]:
    library = forward.hypotheses
    found = [h for h in library if name in (h.label, h.effect)]
    if not found:
        known = {h.label for h in library} | {h.effect for h in library}
        raise UnknownNameError("cause", name, known)
    return found


def separation(base: Linearisation, question: Question, axes: Axes | None = None) -> FloatArray:
    """Chi^2 by which each cause is parted from each other one (k, k), with noise as declared.

    Args:
        base: at nominal, of one programme.
        question: the causes.
        axes: commissioning tolerances that it has; all if None.
    """
    whitening = whitening_declared(base.runs)
    white = changes(base, question, axes)
    metric = Metric(whitening.apply(base.columns).T)
    return parted(white.T @ metric.project(white))


def changes(base: Linearisation, question: Question, axes: Axes | None = None) -> FloatArray:
    """Whitened change (samples, k) that each cause makes at its `size_of`.

    A cause that is a commissioning tolerance too is its column, as in a bank.
    """
    runs, where = base.runs, base.runs.nuisances if axes is None else axes[0]
    own = [np.flatnonzero(np.isin(where, runs.indices(cause))) for cause in question.causes]
    sizes = [size_of(cause) for cause in question.causes]
    straight = [len(rows) == 1 and len(size) == 1 for rows, size in zip(own, sizes, strict=True)]
    simulated = [
        runs.depart(runs.origin, runs.indices(cause), size)
        for cause, size, known in zip(question.causes, sizes, straight, strict=True)
        if not known
    ]
    stacks = iter(runs.many(simulated) - base.prediction if simulated else ())
    found = [
        base.columns[rows[0]] * np.float32(size[0] / runs.sd[where[rows[0]]])
        if known
        else next(stacks)
        for size, rows, known in zip(sizes, own, straight, strict=True)
    ]
    return whitening_declared(runs).apply(np.stack(found)).T


def parted(gram: FloatArray, held: FloatArray | float = 0.0) -> FloatArray:
    """Chi^2 by which each cause is parted from each other one (k, k); infinite from itself.

    min over a of |s_i - a s_j|^2 + (a - 1)^2 D_j^2: what cause j, scaled, leaves of cause i.

    Args:
        gram: <s_i, s_j> (k, k).
        held: D_j^2, by what its size is known already (k,).
    """
    power = np.diag(gram)
    apart = power[:, None] - 2.0 * gram + power
    apart = apart - (gram - power) ** 2 / np.maximum(power + held, 1e-12)
    np.fill_diagonal(apart, np.inf)
    return np.asarray(np.maximum(apart, 0.0))
