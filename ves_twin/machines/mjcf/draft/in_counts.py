"""in_counts: columns in counts that are a joint's by their name, and what a count of them is."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

from ves_twin.machines.mjcf.draft.log_columns import LogColumns
from ves_twin.machines.mjcf.draft.match import Match, Matches, matched
from ves_twin.machines.mjcf.draft.spots import Quantity, Spot

UNIT = "counts"


def without_counts(log: LogColumns, columns: Collection[str]) -> LogColumns:
    """Columns in counts of which a count is known: read by their names, as if without a unit."""
    units = {c: "" if c in columns and u == UNIT else u for c, u in log.units.items()}
    return replace(log, units=units)


def in_counts(log: LogColumns, spots: Sequence[Spot], matches: Matches) -> list[Match]:
    """Columns in counts that are left over, by the joint without a column that has their name.

    The model does not tell what a count is: the joint would be taken as standing still.
    """
    columns = [c for c in matches.left if log.units.get(c) == UNIT]
    if not columns:
        return []
    taken = {match.spot for match in matches.found}
    every = matched(without_counts(log, columns), spots).found
    return [
        match
        for match in every
        if match.column in columns
        and match.spot not in taken
        and match.spot.quantity in (Quantity.POSITION, Quantity.SPEED)
    ]
