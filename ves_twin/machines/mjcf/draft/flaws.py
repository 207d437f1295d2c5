"""words_of_flaws: positions and speeds that drop out, jump, or glitch."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ves_twin.core.types import FloatArray
from ves_twin.data.quality.dropouts import dropouts
from ves_twin.data.quality.jumps import jumps
from ves_twin.data.quality.spikes import spikes
from ves_twin.machines.mjcf.draft.log_columns import LogColumns
from ves_twin.machines.mjcf.draft.match import Match
from ves_twin.machines.mjcf.draft.names import is_setpoint
from ves_twin.machines.mjcf.draft.spots import Quantity


def words_of_flaws(log: LogColumns, found: Sequence[Match]) -> list[str]:
    """A sentence for each flaw of each column of a motion, with the log's own times."""
    efforts = [log.as_logged(m.column) for m in found if m.spot.quantity is Quantity.EFFORT]
    asked = [log.as_logged(c) for c in log.values if is_setpoint(log.said.get(c, c))]
    said = list[str]()
    for match in found:
        if match.spot.quantity in (Quantity.POSITION, Quantity.SPEED):
            said += _dropouts(log, match)
        if match.spot.quantity is Quantity.POSITION:
            said += [*_jumps(log, match, [*efforts, *asked]), *_spikes(log, match)]
    return said


def _dropouts(log: LogColumns, match: Match) -> Iterator[str]:
    values = log.as_logged(match.column)
    if lost := dropouts(values):
        rows = sum(one.stop - one.start for one in lost)
        yield (
            f"{match.column} jumps to {values[lost[0].start]:.4g} and back {len(lost)} times, first"
            f" at {log.stamps[lost[0].start]:.6g} s, for {rows} rows in all: a sensor that dropped"
            " out? Empty those cells, or leave them out by `window`: what is said of this motion"
            " counts them"
        )


def _jumps(log: LogColumns, match: Match, commands: Sequence[FloatArray]) -> Iterator[str]:
    values = log.as_logged(match.column)
    if stays := jumps(values, log.stamps, commands):
        k = stays[0]
        yield (
            f"{match.column} jumps from {values[k]:.4g} to {values[k + 1]:.4g} at"
            f" {log.stamps[k]:.6g} s and stays: two runs in one log, a counter that was set anew,"
            " or a reading that was frozen until then? Leave a part out by `window`, or give each a"
            " file of its own"
        )


def _spikes(log: LogColumns, match: Match) -> Iterator[str]:
    values = log.as_logged(match.column)
    if lone := spikes(values):
        yield (
            f"{match.column} is far from its neighbours in {len(lone)} single rows, first with"
            f" {values[lone[0]]:.4g} at {log.stamps[lone[0]]:.6g} s: glitches of its sensor? Empty"
            " those cells"
        )
