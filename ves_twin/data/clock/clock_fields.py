"""clock_fields: which columns of a table look like its time, the likeliest first."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.data.clock.usual_period import is_usual
from ves_twin.data.formats.log import Block, Column, Kind
from ves_twin.data.formats.unit_names import TIME, bare_name, spelled

_NAMED = re.compile(
    r"^(?:t|time|times|timestamp|time_stamp|stamp|tstamp|zeit|temps|elapsed|clock|tijd|"
    r".*[ _.]?time|.*stamp|rowtimes)$",
    re.IGNORECASE,
)
_NAMELESS = re.compile(r"(?:column|col|c|var|variable|field|unnamed|x|v)?[ _:]*#", re.IGNORECASE)

_COUNTER = re.compile(r"^(?:idx|index|i|n|row|sample|samples|count|counter|seq)$", re.IGNORECASE)

_UNITS = {
    **{unit: unit for unit in ("ms", "us", "ns")},
    **dict.fromkeys(("millis", "millisecond", "milliseconds"), "ms"),
    **dict.fromkeys(("micros", "microsecond", "microseconds"), "us"),
}
"""Names of columns that are a unit of time and nothing else, as counters of small boards are."""

EPOCHS = ((1e9, 4e9, "s"), (1e12, 4e12, "ms"), (1e15, 4e15, "us"), (1e18, 4e18, "ns"))
"""Sizes of a count since 1970 (years 2001 to 2096) in each unit."""

FINER = ("s", "ms", "us")
"""Units that nobody says, the likeliest first; whole numbers are no seconds."""

EVEN = 0.9
"""Share of steps within half of the usual one that a column called q1 beside q2 needs to be a
clock: clocks that jitter by 40 % have all, but for gaps; a rising joint of an arm had 0.63."""


@dataclass(frozen=True)
class ClockField:
    """A column that may be the time; its unit, and whether that is a guess.

    A counter of rows (`counter`) rises as a clock does and tells no time.
    """

    column: str
    unit: str
    guessed: bool
    score: float
    counter: bool

    @property
    def scale(self) -> float:
        """Of the unit [s]."""
        return TIME[self.unit]


def clock_fields(columns: Sequence[Column], block: Block) -> tuple[ClockField, ...]:
    """Columns that rise from row to row, the likeliest time first.

    Args:
        columns: of a table.
        block: its first rows.
    """
    found = []
    timed = [_timed(column) for column in columns if column.kind is not Kind.TEXT]
    for place, column in enumerate(timed):
        if column.name not in block:
            continue
        values = block[column.name]
        score = _score(column, values, place, _numbered(column, columns))
        if score > 0.0:
            unit, guessed = _unit(column, values)
            counter = _counts(column, block[column.name])
            found.append(ClockField(column.name, unit, guessed, score, counter))
    return tuple(sorted(found, key=lambda f: (f.counter, -f.score)))


def _timed(column: Column) -> Column:
    """With the unit that its name is: `ms` behind a text of hours."""
    unit = _UNITS.get(spelled(bare_name(column.name).lower()), "")
    return replace(column, unit=unit) if unit and not column.unit else column


def _numbered(column: Column, columns: Sequence[Column]) -> bool:
    """Whether others are called the same but for a number, as joints are and clocks are not.

    Columns that are called by their place alone tell nothing.
    """
    stem, *others = (re.sub(r"\d+", "#", bare_name(c.name)) for c in (column, *columns))
    return others.count(stem) > 1 and not _NAMELESS.fullmatch(stem)


def _score(column: Column, values: FloatArray, place: int, numbered: bool) -> float:
    values = values[np.isfinite(values)]
    if len(values) < 3:
        return 0.0
    steps = np.diff(values)
    forward = steps[steps > 0.0]
    if np.mean(steps >= 0.0) < 0.9 or len(forward) < 0.2 * len(steps):
        return 0.0
    usual = float(np.median(forward))
    even = float(np.mean(np.abs(forward - usual) < 0.5 * usual))
    told = 2.0 * (column.kind is Kind.STAMP) + 2.0 * bool(_NAMED.match(bare_name(column.name)))
    told += 1.0 * (column.unit in TIME)
    if numbered and not told and even < EVEN:
        return 0.0
    score = even + told + 0.5 * (place == 0)
    return score if score > 1.0 else 0.0


def _counts(column: Column, values: FloatArray) -> bool:
    """Whether a column counts rows: named so, or in steps of one without a name or unit of time."""
    name = bare_name(column.name)
    if column.unit in TIME or _NAMED.match(name):
        return False
    steps = np.diff(values[np.isfinite(values)])
    return bool(_COUNTER.match(name)) or bool(np.all(steps == 1.0))


def _unit(column: Column, values: FloatArray) -> tuple[str, bool]:
    if column.unit in TIME:
        return column.unit, False
    if column.kind is Kind.STAMP:
        return "s", False
    told = values[np.isfinite(values)]
    size = float(np.median(np.abs(told))) if len(told) else np.nan
    for low, high, unit in EPOCHS:
        if low <= size <= high:
            return unit, True
    step = float(np.median(np.abs(np.diff(told)))) if len(told) > 1 else np.nan
    whole = step >= 1.0 and bool(np.all(np.mod(told, 1.0) == 0.0))
    usual = (u for u in FINER if is_usual(step * TIME[u]) and not (whole and u == "s"))
    return next(usual, "ms" if whole else "s"), True
