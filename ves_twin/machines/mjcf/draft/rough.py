"""words_of_rough: positions that jump about like an effort, beside efforts that move smoothly."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.machines.mjcf.draft.log_columns import LogColumns
from ves_twin.machines.mjcf.draft.match import Match
from ves_twin.machines.mjcf.draft.spots import Quantity

STEP = 0.2
"""Rms step of a column from row to row, as a share of its sd, from which on a position is rough;
and share of that which its effort has at most: assumed."""

WHITE = 1.2
"""Rms of a column's second differences over that of its first from which it is no swing: white
noise has the root of 3, five rows a period as much as that."""

STILL = {"rad": 5e-3, "m": 5e-4}
"""Sd of a position up to which it may be the noise of a joint that is held: assumed."""


def words_of_rough(log: LogColumns, found: Sequence[Match]) -> list[str]:
    """A sentence for each position that is noise from row to row where its effort is a motion.

    A position is what two integrals leave of an effort: smoother than that on any machine.
    """
    positions = {m.spot.name: m for m in found if m.spot.quantity is Quantity.POSITION}
    said = []
    for match in found:
        own = positions.get(match.spot.joint) if match.spot.joint else None
        if match.spot.quantity is not Quantity.EFFORT or own is None:
            continue
        place, effort = (log.as_logged(m.column) for m in (own, match))
        moves = float(np.std(abs(own.factor) * place)) > STILL.get(own.spot.unit, np.inf)
        rough = moves and _step(place) > STEP and _white(place)
        if rough and _step(effort) < STEP * _step(place):
            said.append(
                f"{own.column} goes up and down from row to row as no position does, and"
                f" {match.column} does not: are the two swapped?"
            )
    return said


def _step(values: FloatArray) -> float:
    return float(np.std(np.diff(values))) / (float(np.std(values)) or 1.0)


def _white(values: FloatArray) -> bool:
    first = np.diff(values)
    return bool(np.std(np.diff(first)) > WHITE * np.std(first))
