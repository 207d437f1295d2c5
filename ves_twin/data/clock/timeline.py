"""Timeline: the times of a table's rows on one clock, made strictly increasing."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray, IntArray
from ves_twin.data.clock.clock_report import longest_step, usual_step
from ves_twin.data.mapping.import_map import Backward, ClockMap, Repeats


@dataclass(frozen=True)
class Timeline:
    """Rows that are kept, and when they were taken.

    Attributes:
        time: strictly increasing [s] (n,).
        rows: their place among the rows of the table (n,).
        period: usual step [s].
        repeats: rows left out because the time of the row before repeats.
        back: rows that step back, sorted in or dropped.
        missing: rows without a time, left out.
        gaps: steps longer than 1.5 periods.
        longest: the longest of them [s].
        jitter: sd of the steps that are no gaps, in periods; of the file, also where `even`.
    """

    time: FloatArray
    rows: IntArray
    period: float
    repeats: int
    back: int
    missing: int
    gaps: int
    longest: float
    jitter: float

    @staticmethod
    def of(raw: FloatArray, scale: float, told: ClockMap, where: str) -> Timeline:
        """Put the rows of a clock in order as its map says.

        Args:
            raw: times as the file has them (n,).
            scale: of their unit [s].
            told: what becomes of repeats and steps back.
            where: name of the column, for messages.

        Raises:
            InvalidInputError: no two times; or a step back or a repeat that the map refuses.
        """
        good = np.flatnonzero(np.isfinite(raw))
        time = raw[good] * scale
        missing = len(raw) - len(good)
        steps = np.diff(time)
        back = np.flatnonzero(steps < 0.0)
        if len(back):
            time, good = _ordered(time, good, int(back[0]), len(back), told.backward, where)
        same = np.flatnonzero(np.diff(time) == 0.0)
        if len(same) and told.repeats is Repeats.REFUSE:
            came = f"{len(same)} rows with the time of the row before, first at {time[same[0]]} s"
            raise InvalidInputError(where, came, 'times that rise, or repeats = "first" or "last"')
        drop = same if told.repeats is Repeats.LAST else same + 1
        keep = np.ones(len(time), dtype=bool)
        keep[drop] = False
        time, good = time[keep], good[keep]
        if len(time) < 2:
            raise InvalidInputError(where, f"{len(time)} rows with a time", "at least 2")
        period = usual_step(time)
        steps = np.diff(time)
        most = longest_step(steps, period)
        wide = steps[steps > most]
        longest = float(wide.max()) if len(wide) else 0.0
        even = steps[steps <= most]
        jitter = float(np.std(even)) / period if len(even) else 0.0
        if told.even:
            time = _straightened(time, period, most)
        return Timeline(
            time, good, period, len(same), len(back), missing, len(wide), longest, jitter
        )

    @staticmethod
    def even(rows: int, rate: float) -> Timeline:
        """Rows at an even rate [Hz] that the map declares."""
        time = np.asarray(np.arange(rows) / rate, np.float64)
        return Timeline(time, np.arange(rows), 1.0 / rate, 0, 0, 0, 0, 0.0, 0.0)

    def shifted(self, by: float) -> Timeline:
        """The same rows with a time added [s]."""
        return replace(self, time=self.time + by)

    def to_dict(self) -> dict[str, object]:
        """Plain values for an account."""
        return {
            "rows": len(self.time),
            "rate": 1.0 / self.period,
            "start": float(self.time[0]),
            "stop": float(self.time[-1]),
            "repeats": self.repeats,
            "back": self.back,
            "missing": self.missing,
            "gaps": self.gaps,
            "longest_gap": self.longest,
            "jitter": self.jitter,
        }


def _straightened(time: FloatArray, period: float, longest: float) -> FloatArray:
    """Stamps on the straight line through them; a gap counts as the rows that fit into it."""
    steps = np.diff(time)
    rows = np.where(steps > longest, np.maximum(np.round(steps / period), 1.0), 1.0)
    count = np.concatenate([[0.0], np.cumsum(rows)])
    slope, start = np.polyfit(count, time - time[0], 1)
    return np.asarray(time[0] + start + slope * count)


def _ordered(
    time: FloatArray, rows: IntArray, first: int, count: int, told: Backward, where: str
) -> tuple[FloatArray, IntArray]:
    if told is Backward.REFUSE:
        came = f"{count} steps back, first after row {rows[first] + 1} at {time[first]:.6g} s"
        wanted = 'rising times; in the map backward = "drop" or "sort" says what to do'
        raise InvalidInputError(where, came, wanted)
    if told is Backward.SORT:
        order = np.argsort(time, kind="stable")
        return time[order], rows[order]
    high = np.maximum.accumulate(time)
    keep = time >= high
    return time[keep], rows[keep]
