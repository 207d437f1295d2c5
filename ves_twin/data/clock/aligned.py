"""align: the columns that a map asks for, and the times of their rows on the main clock."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.types import FloatArray
from ves_twin.data.clock.clock_fields import clock_fields
from ves_twin.data.clock.clock_offset import clock_offset
from ves_twin.data.clock.timeline import Timeline
from ves_twin.data.formats.log import Column, Kind, Log
from ves_twin.data.formats.unit_names import TIME
from ves_twin.data.mapping.import_map import MAIN, ClockMap, ImportMap, Keep, OtherClock
from ves_twin.data.mapping.targets import Target

Place = tuple[str, str]
"""Table and column."""


@dataclass(frozen=True)
class Aligned:
    """Columns in memory and their clocks.

    Attributes:
        values: (table, column) -> numbers of the file (k,).
        lines: (table, clock) -> when its rows were taken, on the main clock from its begin on.
        rows_of_main: the rows that the recording gets if no rate is asked for.
        origin: what was taken off the main clock's readings [s].
        offsets: what was found of other clocks, for the account.
        notes: what was done, in words.
    """

    values: dict[Place, FloatArray]
    lines: dict[tuple[str, str], Timeline]
    rows_of_main: Timeline
    origin: float
    offsets: dict[str, dict[str, object]]
    notes: tuple[str, ...]

    @property
    def clocks(self) -> dict[str, Timeline]:
        """Every clock in use, named with its table where it has one."""
        return {f"{c} of {t}" if t else c: line for (t, c), line in self.lines.items()}

    def line(self, target: Target) -> Timeline:
        """When a channel's rows were taken."""
        return self.lines[target.table, target.channel.clock]


def align(log: Log, told: ImportMap, targets: tuple[Target, ...]) -> Aligned:
    """Read what a map needs and put its clocks together.

    Raises:
        UnknownNameError: a time column or a column to align by that does not exist.
        InvalidInputError: times that do not rise, 0 rows, or clocks that cannot be aligned.
    """
    asked = tuple(_asked(log, told, targets))
    values: dict[Place, FloatArray] = {}
    for table in dict.fromkeys(t for t, _ in asked):
        columns = list(dict.fromkeys(c for t, c in asked if t == table))
        read = log.read(table, columns)
        values |= {(table, c): rows for c, rows in read.items()}
        if not len(read[columns[0]]):
            what = f"table {table} of {log.path.name}" if table else log.path.name
            raise InvalidInputError(what, "0 rows", "rows of numbers")
    lines = {}
    for table, on in dict.fromkeys((t.table, t.channel.clock) for t in targets):
        lines[table, on] = _line(log, told, values, table, on)
    mains = [line for (_, on), line in lines.items() if on == MAIN]
    if not mains:
        raise InvalidInputError("clock", "no channel on the main one", "at least one")
    rows = max(mains, key=lambda line: len(line.time))
    origin = float(rows.time[0])
    lines = {key: line.shifted(-origin) for key, line in lines.items()}
    notes: list[str] = []
    offsets: dict[str, dict[str, object]] = {}
    for name, clock in told.clocks.items():
        shift, found, words = _offset(log, told, name, clock, values, lines, origin)
        notes += words
        offsets[name] = found
        lines = {k: line.shifted(shift) if k[1] == name else line for k, line in lines.items()}
    return Aligned(values, lines, rows.shifted(-origin), origin, offsets, tuple(notes))


def clock_of(told: ImportMap, name: str) -> ClockMap:
    """A clock of a map by name."""
    return told.clock if name == MAIN else told.clocks[name]


def _asked(log: Log, told: ImportMap, targets: tuple[Target, ...]) -> Iterator[Place]:
    names = log.full_names()
    places = [t.place for t in targets]
    for target in targets:
        column = _time_column(log, told, target.table, target.channel.clock)
        if column is not None:
            places.append((target.table, column.name))
    for clock in told.clocks.values():
        for full, on in ((clock.own, clock), (clock.main, told.clock)):
            if full is None:
                continue
            if full not in names:
                raise UnknownNameError(f"column in {log.path.name}", full, names)
            table, column = names[full]
            _check_numbers(log, column)
            places.append((table.name, column.name))
            if on.column is not None:
                places.append((table.name, _named(log, table.name, on.column).name))
    yield from dict.fromkeys(places)


def _time_column(log: Log, told: ImportMap, table: str, clock: str) -> Column | None:
    name = clock_of(told, clock).column
    return None if name is None else _named(log, table, name)


def _named(log: Log, table: str, name: str) -> Column:
    """A time column of a table, by its own or its full name."""
    here = log.table(table)
    for column in here.columns:
        if name in (column.name, here.full_name(column.name)):
            _check_numbers(log, column)
            return column
    what = f"time column in table {table}" if table else f"time column in {log.path.name}"
    raise UnknownNameError(what, name, [c.name for c in here.columns])


def _check_numbers(log: Log, column: Column) -> None:
    if column.kind is Kind.TEXT:
        what = f"column in {log.path.name} {column.name}"
        raise InvalidInputError(what, "a text, list or other thing", "times or numbers")


def _line(
    log: Log, told: ImportMap, values: dict[Place, FloatArray], table: str, clock: str
) -> Timeline:
    told_clock = clock_of(told, clock)
    if told_clock.column is None:
        rows = next(len(v) for (t, _), v in values.items() if t == table)
        return Timeline.even(rows, told_clock.rate or 1.0)
    column = _named(log, table, told_clock.column)
    raw = values[table, column.name]
    full = log.table(table).full_name(column.name)
    return Timeline.of(raw, TIME[_unit(column, raw, told_clock, full)], told_clock, full)


def _unit(column: Column, raw: FloatArray, told: ClockMap, full: str) -> str:
    if column.kind is Kind.STAMP:
        return "s"
    if told.unit is not None:
        return told.unit
    if column.unit in TIME:
        return column.unit
    fields = clock_fields([column], {column.name: raw[:10_000]})
    hint = f", perhaps {fields[0].unit}" if fields else ""
    raise InvalidInputError(f"unit of {full}", f"none in file or map{hint}", 'unit = "s"')


def _offset(
    log: Log,
    told: ImportMap,
    name: str,
    clock: OtherClock,
    values: dict[Place, FloatArray],
    lines: dict[tuple[str, str], Timeline],
    origin: float,
) -> tuple[float, dict[str, object], list[str]]:
    """What is added to a clock's lines [s], what was found, and words."""
    if not isinstance(clock.offset, str):
        return clock.offset, {"value": clock.offset, "basis": "given", "removed": True}, []
    names = log.full_names()
    pairs = []
    for full, on in ((clock.own, name), (clock.main, MAIN)):
        table, column = names[str(full)]
        line = lines.get((table.name, on))
        if line is None:
            line = _line(log, told, values, table.name, on).shifted(-origin)
        pairs.append((line, values[table.name, column.name][line.rows]))
    (own, own_values), (main, main_values) = pairs
    start, words = 0.0, []
    if own.time[0] > main.time[-1] or own.time[-1] < main.time[0]:
        start = float(main.time[0] - own.time[0])
        words = [f"clock {name}: reads other dates than the main one; taken to begin with it"]
    found = clock_offset(own.time + start, own_values, main.time, main_values, clock.search)
    total = start + found.value
    removed = clock.keep is Keep.REMOVED and found.unique
    content: dict[str, object] = {
        "value": total,
        "sd": found.sd,
        "correlation": found.correlation,
        "rival": found.rival,
        "drift": found.drift,
        "drift_sd": found.drift_sd if np.isfinite(found.drift_sd) else None,
        "basis": f"{clock.own} against {clock.main}",
        "removed": removed,
    }
    done = "removed" if removed else "kept as a hypothesis, not removed"
    if not found.unique:
        done += f": another offset does {found.rival:.0%} as well"
    words.append(
        f"clock {name}: {total:+.6g} s to the main one (sd {found.sd:.2g} s, correlation"
        f" {found.correlation:+.3f} of {clock.own} with {clock.main}); {done}"
    )
    if found.drifts:
        ppm, sd = 1e6 * found.drift, 1e6 * found.drift_sd
        words.append(f"clock {name}: runs off by {ppm:+.3g} ppm (sd {sd:.2g}), which stays")
    return (total if removed else start), content, words
