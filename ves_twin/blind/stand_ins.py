"""stand_ins: what else of the library would leave hardly anything of a cause."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from ves_twin.blind.draw import LOUDNESS
from ves_twin.blind.truth import Truth
from ves_twin.diagnosis.bank import Bank, build_bank
from ves_twin.diagnosis.runs import Runs
from ves_twin.diagnosis.screen import Screen
from ves_twin.diagnosis.whitening import whitening_declared
from ves_twin.types import FloatArray, IntArray


def stand_ins(runs: Runs, truths: Sequence[Truth]) -> list[tuple[tuple[str, ...], ...]]:
    """Causes, alone or two together, that a cause could be taken for at its size.

    A stand-in leaves d < LOUDNESS[0] of the cause's trace at noise and tolerances as declared:
    less than a diagnosis is asked to see. It is told before anything is diagnosed.

    Args:
        runs: of the programme.
        truths: each with one cause.
    """
    if not truths:
        return []
    bank = build_bank(runs)
    screen = Screen(bank, whitening_declared(runs))
    return [_of(screen, bank, truth) for truth in truths]


def _of(screen: Screen, bank: Bank, truth: Truth) -> tuple[tuple[str, ...], ...]:
    runs, cause = bank.base.runs, truth.causes[0]
    hypothesis = next(h for h in bank.hypotheses if h.label == cause.label)
    shift = runs.origin
    shift[runs.indices(hypothesis)] = [cause.departures[p] for p in hypothesis.parameters]
    trace = screen.whitening.apply(runs.one(shift) - bank.base.prediction)
    power = float(trace @ screen.metric.project(trace))
    match = screen.match(trace)
    others = [h for h, other in enumerate(bank.hypotheses) if other.label != cause.label]
    near = {h: _nearest(bank.entries(h), match, screen.power) for h in others}
    found = []
    for count in (1, 2):
        for group in combinations(others, count):
            rows = np.array([near[h] for h in group])
            gram = screen.gram[np.ix_(rows, rows)] + 1e-9 * np.diag(screen.power[rows])
            taken = float(match[rows] @ np.linalg.solve(gram, match[rows]))
            if power - taken < LOUDNESS[0] ** 2:
                found.append(tuple(bank.hypotheses[h].label for h in group))
    return tuple(found)


def _nearest(rows: IntArray, match: FloatArray, power: FloatArray) -> int:
    """The entry that explains most, at whatever scale."""
    return int(rows[np.argmax(match[rows] ** 2 / power[rows])])
