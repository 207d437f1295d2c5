"""words_of_dropouts: positions and speeds that stand at one value, far off, for some rows."""

from __future__ import annotations

from collections.abc import Sequence

from ves_twin.data.quality.dropouts import dropouts
from ves_twin.machines.mjcf.draft.log_columns import LogColumns
from ves_twin.machines.mjcf.draft.match import Match
from ves_twin.machines.mjcf.draft.spots import Quantity


def words_of_dropouts(log: LogColumns, found: Sequence[Match]) -> list[str]:
    """A sentence for each column of a motion whose sensor seems to have dropped out."""
    said = []
    for match in found:
        if match.spot.quantity not in (Quantity.POSITION, Quantity.SPEED):
            continue
        values = log.as_logged(match.column)
        lost = dropouts(values)
        if lost:
            rows = sum(one.stop - one.start for one in lost)
            said.append(
                f"{match.column} jumps to {values[lost[0].start]:.4g} and back {len(lost)} times,"
                f" first {lost[0].start + 1} rows from its begin, for {rows} rows in all: a sensor"
                " that dropped out? Empty those cells, or leave them out by `window`: what is said"
                " of this motion counts them"
            )
    return said
