"""words_of_dropouts: positions and speeds that jump, for some rows or for good."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ves_twin.data.quality.dropouts import dropouts
from ves_twin.data.quality.jumps import jumps
from ves_twin.data.quality.spikes import spikes
from ves_twin.machines.mjcf.draft.log_columns import LogColumns
from ves_twin.machines.mjcf.draft.match import Match
from ves_twin.machines.mjcf.draft.spots import Quantity


def words_of_dropouts(log: LogColumns, found: Sequence[Match]) -> list[str]:
    """A sentence for each column of a motion whose sensor dropped out, or that is of two runs."""
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
        stays = jumps(values, np.arange(len(values), dtype=float))
        if stays and match.spot.quantity is Quantity.POSITION:
            k = stays[0]
            said.append(
                f"{match.column} jumps from {values[k]:.4g} to {values[k + 1]:.4g} behind row"
                f" {k + 1} and stays: two runs in one log, a counter that was set anew, or a"
                " reading that was frozen until then? Leave a part out by `window`, or give each"
                " a file of its own"
            )
        lone = spikes(values) if match.spot.quantity is Quantity.POSITION else ()
        if lone:
            said.append(
                f"{match.column} is far from its neighbours in {len(lone)} single rows, first with"
                f" {values[lone[0]]:.4g} in row {lone[0] + 1}: glitches of its sensor? Empty those"
                " cells"
            )
    return said
