"""lookalikes: causes that a recording confuses, and the sizes from which it no longer does."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from ves_twin.core.types import FloatArray, IntArray
from ves_twin.diagnosis.bank.screen import AMPLITUDE, Screen
from ves_twin.diagnosis.experiment.findable import MARGIN, crossing

CLEAR = 1.05
"""Two causes are confused if one must be this many times its smallest findable size to be told."""


@dataclass(frozen=True)
class Lookalike:
    """A cause that is taken for another one below a size.

    Attributes:
        cause: effect@target.
        other: effect@target of what it is taken for.
        beyond: size from which it is told from it; None if at no size in its range.
        unit: of that size.
        largest: end of its range.
    """

    cause: str
    other: str
    beyond: float | None
    unit: str
    largest: float


def lookalikes(
    screen: Screen,
    findable: dict[str, float | None],
    odds: float,
    model_error: float,
    among: Collection[str] | None = None,
) -> list[Lookalike]:
    """Which findable cause would be taken for which other one.

    At size e cause i is told from j if what the best scaled j leaves of it,
    d^2 = min over a of |s_i(e) - a s_j|^2 with commissioning errors marginalised, exceeds
    2 ln(odds) plus the error that the model of i may have, (model_error)^2 |s_i|^2, by MARGIN
    of the 2 d by which the difference of the two chi^2 scatters.

    Args:
        screen: the bank under the noise as it is expected.
        findable: smallest findable size of each cause; what cannot be found is left out.
        odds: at which a rival is dropped.
        model_error: relative error of a simulated change.
        among: causes, effect@target, whose look-alikes are asked for; all if None.
    """
    bank = screen.bank
    found = []
    for i, cause in enumerate(bank.hypotheses):
        least = findable.get(cause.label)
        rows = bank.entries(i)
        asked = among is None or cause.label in among
        if not asked or least is None or not len(rows) or len(cause.parameters) > 1:
            continue
        sizes = np.array([bank.sizes[k][0] for k in rows])
        power = screen.power[rows]
        least_odds = 2.0 * float(np.log(odds))
        unit = _unit(screen, i)
        for j, other in enumerate(bank.hypotheses):
            theirs = bank.entries(j)
            if j == i or not len(theirs):
                continue
            left = np.maximum(_left(screen, rows, theirs), 0.0)
            beyond = _beyond(sizes, left, model_error**2 * power, least_odds)
            if beyond is None or beyond > CLEAR * least:
                found.append(Lookalike(cause.label, other.label, beyond, unit, cause.largest[0]))
    return found


def _left(screen: Screen, rows: IntArray, theirs: IntArray) -> FloatArray:
    """What the best scaled entry of another cause leaves of each entry (rows,)."""
    match, power = screen.gram[np.ix_(rows, theirs)], screen.power[theirs]
    a = np.clip(match / power, *AMPLITUDE)
    return np.asarray(screen.power[rows] - np.max(2.0 * a * match - a**2 * power, axis=1))


def _beyond(sizes: FloatArray, left: FloatArray, doubt: FloatArray, odds: float) -> float | None:
    """Size from which it is told in every direction; None if one is never told.

    Args:
        sizes: of the bank's entries (k,).
        left: what the other cause leaves of each, d^2 (k,).
        doubt: chi^2 that the model of each may be wrong by (k,).
        odds: chi^2 that a rival must be behind.
    """
    ends = [
        _end(np.abs(sizes[sizes * sign > 0]), left[sizes * sign > 0], doubt[sizes * sign > 0], odds)
        for sign in (-1, 1)
        if np.any(sizes * sign > 0)
    ]
    known = [end for end in ends if end is not None]
    return max(known) if len(known) == len(ends) else None


def _end(sizes: FloatArray, left: FloatArray, doubt: FloatArray, odds: float) -> float | None:
    goal = MARGIN + np.sqrt(MARGIN**2 + odds + doubt)
    first = int(np.argmin(sizes))
    if np.sqrt(left[first]) < goal[first]:
        return crossing(sizes, np.sqrt(left) / goal, 1.0)
    # below the smallest entry both fall with the square of the size: the doubt as well as the rest
    rest, root = float(left[first] - doubt[first]), MARGIN * float(np.sqrt(left[first]))
    return float(sizes[first] * (root + np.sqrt(root**2 + rest * odds)) / rest)


def _unit(screen: Screen, hypothesis: int) -> str:
    runs = screen.bank.base.runs
    index = int(runs.indices(screen.bank.hypotheses[hypothesis])[0])
    return runs.coordinates[index].parameter.unit
