"""with_steady: a command that never changes, as of a step test, in a log without any other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ves_twin.machines.mjcf.draft.log_columns import LogColumns
from ves_twin.machines.mjcf.draft.match import Matches, matched
from ves_twin.machines.mjcf.draft.spots import Quantity, Spot, words_of

SETTINGS = frozenset(
    ["supply", "battery", "bus", "limit", "max", "min", "rated", "nominal", "offset", "gain"]
)
"""Words of what is set once, and drives nothing."""


def with_steady(
    log: LogColumns, matches: Matches, spots: Sequence[Spot]
) -> tuple[LogColumns, Matches]:
    """The columns with those commands among them, and what all are taken for.

    A column that holds one number tells neither a sign nor a constant, and what does not move may
    be a reading that is stuck: only where no column of an effort moves is one taken.

    Args:
        log: the columns.
        matches: of those that change.
        spots: of the model.
    """
    if not log.steady or matches.of(Quantity.EFFORT):
        return log, matches
    efforts = [s for s in spots if s.quantity is Quantity.EFFORT]
    steady = {c: rows for c, rows in log.steady.items() if not SETTINGS & {*words_of(log.said[c])}}
    found = matched(replace(log, values=steady), efforts).found
    if not found:
        return log, matches
    held = {m.column: log.steady[m.column] for m in found}
    order = {spot: i for i, spot in enumerate(spots)}
    taken = {m.spot.label for m in found}
    rest = [
        replace(m, others=tuple(o for o in m.others if not o.endswith(tuple(taken))))
        for m in matches.found
    ]
    every = tuple(sorted((*rest, *found), key=lambda m: order[m.spot]))
    left = {column: why for column, why in matches.left.items() if column not in held}
    return replace(log, values={**log.values, **held}), replace(matches, found=every, left=left)
