"""inspect_log: what is in a lab file: channels, rates, ranges, gaps, clock fields."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from itertools import chain

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.data.clock.clock_fields import ClockField, clock_fields
from ves_twin.data.clock.clock_report import ClockCounter, ClockReport
from ves_twin.data.formats.log import Block, Kind, KnownRanges, Log, Table

EVERY_ROW = "every row"


@dataclass(frozen=True)
class ChannelReport:
    """One column.

    Attributes:
        name: its full name, as a map calls it.
        unit: as the file says; empty if it does not.
        kind: number, stamp or text.
        low, high: its range; None where it holds no numbers.
        missing: rows without a number; None where not counted.
        changes: share of the rows whose value differs from the row before; None: not counted.
        said: what the file calls it beside its name; empty: nothing.
    """

    name: str
    unit: str
    kind: Kind
    low: float | None
    high: float | None
    missing: int | None
    changes: float | None
    said: str = ""


@dataclass(frozen=True)
class TableReport:
    """One table: its rows, its suspected clock and the other candidates, its channels.

    Attributes:
        name: empty where the file is one table.
        rows: number of rows.
        clock: the likeliest time column; None if none rises.
        candidates: other columns that look like a clock.
        basis: what the ranges were told from.
        channels: every column but the clock.
    """

    name: str
    rows: int
    clock: ClockReport | None
    candidates: tuple[str, ...]
    basis: str
    channels: tuple[ChannelReport, ...]


@dataclass(frozen=True)
class Inspection:
    """What is in a lab file, and what of it cannot be read."""

    file: str
    form: str
    size: int
    tables: tuple[TableReport, ...]
    faults: tuple[str, ...]

    def to_dict(self) -> dict[str, object]:
        """Plain values for JSON."""
        content = asdict(self)
        for table, report in zip(content["tables"], self.tables, strict=True):
            if report.clock is not None:
                table["clock"]["rate"] = report.clock.rate
        return content


def inspect_log(log: Log) -> Inspection:
    """Read a lab file once, in pieces, and tell what is in it.

    Ranges come from what the file knows of itself where it does; then only its clock is read.
    """
    reports = tuple(_table(log, table) for table in log.tables)
    return Inspection(str(log.path), log.form, log.path.stat().st_size, reports, log.faults)


def _table(log: Log, table: Table) -> TableReport:
    known = log.known_ranges(table.name)
    names = [c.name for c in table.columns if c.kind is not Kind.TEXT]
    pieces = log.blocks(table.name, names)
    first = next(pieces, None) if names else None
    if first is None:
        rows = table.rows or 0
        return TableReport(table.name, rows, None, (), EVERY_ROW, _channels(table, {}, known, ""))
    fields = clock_fields(table.columns, first)
    counter = _counter(fields[0]) if fields and not fields[0].counter else None
    counts = {name: _Counter() for name in names}
    rows = 0
    if known is not None and counter is not None:
        pieces = log.blocks(table.name, [counter.column])
        rest: Iterator[Block] = pieces
    elif known is not None:
        rest, rows = iter(()), table.rows or 0
    else:
        rest = chain([first], pieces)
    for block in rest:
        rows += len(next(iter(block.values())))
        if counter is not None:
            counter.take(block[counter.column])
        if known is None:
            for name in names:
                counts[name].take(block[name])
    return TableReport(
        table.name,
        rows,
        counter.report() if counter else None,
        tuple(table.full_name(f.column) for f in (fields[1:] if counter else fields)),
        known.basis if known else EVERY_ROW,
        _channels(table, counts, known, counter.column if counter else ""),
    )


def _counter(field: ClockField) -> ClockCounter:
    return ClockCounter(field.column, field.unit, field.guessed, field.scale)


def _channels(
    table: Table, counts: dict[str, _Counter], known: KnownRanges | None, clock: str
) -> tuple[ChannelReport, ...]:
    found = []
    for column in table.columns:
        if column.name == clock:
            continue
        low = high = changes = missing = None
        if known is not None and column.name in known.extremes:
            extremes = known.extremes[column.name]
            low, high = extremes.low, extremes.high
        elif known is None and column.name in counts:
            low, high, missing, changes = counts[column.name].told()
        name = table.full_name(column.name)
        counted = low, high, missing, changes
        found.append(ChannelReport(name, column.unit, column.kind, *counted, column.said))
    return tuple(found)


class _Counter:
    """Range, missing rows and changes of a column, piece by piece."""

    def __init__(self) -> None:
        self._low, self._high = np.inf, -np.inf
        self._rows = self._missing = self._changes = 0
        self._last = np.nan

    def take(self, values: FloatArray) -> None:
        if not len(values):
            return
        self._changes += int(np.count_nonzero(values[1:] != values[:-1]))
        self._changes += int(self._rows > 0 and values[0] != self._last)
        self._rows += len(values)
        self._last = float(values[-1])
        low, high = float(values.min()), float(values.max())
        if not (np.isfinite(low) and np.isfinite(high)):
            good = values[np.isfinite(values)]
            self._missing += len(values) - len(good)
            if not len(good):
                return
            low, high = float(good.min()), float(good.max())
        self._low, self._high = min(self._low, low), max(self._high, high)

    def told(self) -> tuple[float | None, float | None, int, float | None]:
        if self._high < self._low:
            return None, None, self._missing, None
        changes = self._changes / (self._rows - 1) if self._rows > 1 else None
        return self._low, self._high, self._missing, changes
