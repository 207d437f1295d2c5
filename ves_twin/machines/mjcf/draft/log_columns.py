"""LogColumns: the one table of a log that a draft is made of, on an even clock."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import BoolArray, FloatArray
from ves_twin.data.clock.clock_fields import ClockField, clock_fields
from ves_twin.data.clock.clock_report import GAP, UNEVEN, longest_step, usual_step
from ves_twin.data.clock.unwrapped import unwrapped
from ves_twin.data.clock.usual_period import is_usual
from ves_twin.data.empty_cells import FEW, filled, lone
from ves_twin.data.formats.log import Column, Kind
from ves_twin.data.formats.open_log import open_log
from ves_twin.data.mapping.column_expression import ColumnExpression
from ves_twin.data.repeats import read_at, repeats, unheld
from ves_twin.machines.mjcf.draft.said import said
from ves_twin.machines.mjcf.motion.smoothed import smoothed

FEWEST = 64
"""Rows below which neither noise nor motion can be told."""

FILLED = 0.9
"""Share of its rows that a column must fill to be used; of the others the stretch is."""

FIRST = 3
"""Names that a refusal tells of a group."""

JITTER = 0.01
"""Departure of a step from the usual one from which on a draft says so."""

TURNS = {"rad": 2.0 * np.pi, "deg": 360.0}
"""Unit of an angle -> what a turn is in it."""

STEPS = 5.0
"""Steps of its resolution that a column's sd must have for a constant to be read off it: currents
of a wrist with 2 to 4 made 896 and 2470 N m per A, where other motors of it have 9 to 16."""

LEVELS, DITHERS = 5, 0.1
"""Levels, and share of rows that change, from which few steps are a resolution: a switched command
has two or three, and volts in steps hold theirs."""


@dataclass(frozen=True)
class Readings:
    """What a column says whose readings stand in the log until the next one comes.

    Attributes:
        repeats: rows that each stands for.
        values: at even steps, straight between readings.
        alone: the readings.
    """

    repeats: int
    values: FloatArray
    alone: FloatArray


@dataclass(frozen=True)
class LogColumns:
    """Columns of numbers of a log.

    Attributes:
        file: its name.
        clock: column of the time; empty where the rate was given.
        scale: of its unit [s].
        period: usual step [s].
        values: column -> rows (n,) at even steps.
        units: column -> unit as the file or the name says it; empty if neither does.
        constant: columns that never change.
        steady: rows of those that hold a number, as the volts of a step.
        slower: column -> its readings, of those that come more slowly than the rows.
        empty: columns that hold no number in many rows.
        notes: what a reader of the draft should know, a sentence each.
        window: first and last time of the rows that are used [s]; None: all.
        logged: column -> the same rows as they stand in the log, whatever its steps.
        called: column -> what the file calls it beside its name; of those that it does.
        shortest: length of the shortest of other logs that are diagnosed with it [s]; 0: none.
        stamps: time of each row of `logged` [s].
    """

    file: str
    clock: str
    scale: float
    period: float
    values: Mapping[str, FloatArray]
    units: Mapping[str, str]
    constant: tuple[str, ...]
    empty: tuple[str, ...]
    notes: tuple[str, ...]
    window: tuple[float, float] | None = None
    logged: Mapping[str, FloatArray] = field(default_factory=dict)
    called: Mapping[str, str] = field(default_factory=dict)
    steady: Mapping[str, FloatArray] = field(default_factory=dict)
    slower: Mapping[str, Readings] = field(default_factory=dict)
    shortest: float = 0.0
    stamps: FloatArray = field(default_factory=lambda: np.zeros(0))
    _smooth: dict[tuple[str, float], FloatArray] = field(
        default_factory=dict, init=False, repr=False, compare=False
    )

    @property
    def rows(self) -> int:
        """Of every column."""
        return len(next(iter(self.values.values())))

    @property
    def fewest(self) -> int:
        """Rows that the shortest of the logs diagnosed together has at this one's rate."""
        return min(self.rows, int(self.shortest / self.period + 1e-6) or self.rows)

    def beside(self, others: Sequence[Path], rate: float | None) -> LogColumns:
        """With the length of the shortest of other logs; what cannot be read is told elsewhere."""
        lengths = []
        for path in others:
            with suppress(InvalidInputError):
                other = LogColumns.read(path, rate)
                lengths.append(other.rows * other.period)
        return replace(self, shortest=min(lengths, default=0.0))

    @cached_property
    def said(self) -> Mapping[str, str]:
        """What the name of each column says, or what the file calls it."""
        return {**said([*self.values, *self.steady]), **self.called}

    def column(self, text: str) -> FloatArray:
        """Rows (n,) of a column, or of a formula of columns as a machine's file may hold one."""
        found = self.values.get(text)
        return ColumnExpression(text).value(self.values) if found is None else found

    def smooth(self, text: str, corner: float) -> FloatArray:
        """The same (n,) behind a low-pass [Hz] without phase; kept, as it is asked for often."""
        if (text, corner) not in self._smooth:
            self._smooth[text, corner] = smoothed(self.column(text), self.period, corner)
        return self._smooth[text, corner]

    def as_logged(self, text: str) -> FloatArray:
        """The same without interpolation, which takes half of the noise of jittering rows away."""
        return replace(self, values=self.logged or self.values).column(text)

    def between(self, columns: Collection[str]) -> LogColumns:
        """With those of some columns that come more slowly than rows taken between readings."""
        slower = {name: one for name, one in self.slower.items() if name in columns}
        values = {**self.values, **{name: one.values for name, one in slower.items()}}
        return replace(self, values=values, slower=slower)

    def readings(self, text: str) -> tuple[FloatArray, float]:
        """Rows of a column without any that is repeated, and the step between them [s]."""
        slower = self.slower.get(text)
        if slower is None:
            return self.as_logged(text), self.period
        return slower.alone, self.period * self.rows / len(slower.alone)

    def is_coarse(self, text: str) -> bool:
        """Whether a column's sd is less than STEPS of its resolution: it hardly tells anything.

        Its levels must change from row to row: volts in steps have few levels, too, and hold them.
        """
        values = self.as_logged(text)
        values = values[np.isfinite(values)]
        levels, changes = np.unique(values), np.count_nonzero(np.diff(values))
        if len(levels) < LEVELS or changes < DITHERS * len(values):
            return False
        return float(np.std(values)) < STEPS * float(np.median(np.diff(levels)))

    @staticmethod
    def read(path: Path, rate: float | None = None) -> LogColumns:
        """The largest table of a log.

        Args:
            path: of any format that `ves-twin inspect` reads.
            rate: rows a second, where no column tells the time.

        Raises:
            FileAccessError: missing file.
            InvalidInputError: too few rows or columns, or no clock.
        """
        log = open_log(path)
        table = max(log.tables, key=lambda t: (t.rows or 0) * len(t.columns) or len(t.columns))
        names = [c.name for c in table.columns if c.kind is not Kind.TEXT]
        read = log.read(table.name, names) if names else {}
        if len(names) < 2 or min(map(len, read.values())) < FEWEST:
            rows = min(map(len, read.values()), default=0)
            came = f"{len(names)} columns of numbers, {rows} rows"
            raise InvalidInputError(path.name, came, f"2 columns and {FEWEST} rows at least")
        fields = [f for f in clock_fields(table.columns, read) if not f.counter]
        if not fields and rate is None:
            came = f"no column that rises like a time among {', '.join(names[:8])}"
            raise InvalidInputError(path.name, came, "one, or --rate with the rows a second")
        notes: list[str] = []
        clock, scale, period = "", 1.0, 1.0 / (rate or 1.0)
        if rate is None:
            clock, scale = fields[0].column, fields[0].scale
            if fields[0].guessed:
                ones = bool(np.all(np.diff(read[clock]) == 1.0))
                counts = ": if it counts rows, --rate says how many a second" * ones
                notes.append(f"clock {clock}: {_guessed(fields[0], read[clock])}{counts}")
            period = _period(scale * read[clock], clock, notes)
        full = {c.name: table.full_name(c.name) for c in table.columns}
        named = [replace(c, name=full[c.name]) for c in table.columns]
        read = {full[name]: rows for name, rows in read.items()}
        return _sorted(named, read, full.get(clock, ""), scale, period, path, notes)


def _guessed(field: ClockField, stamps: FloatArray) -> str:
    """That its unit is a guess, and the rate that follows where it is no second."""
    told = f"no unit is given, {field.unit} is a guess"
    step = field.scale * usual_step(stamps[np.isfinite(stamps)])
    return told if field.unit == "s" or not step else f"{told}, which makes {1.0 / step:.3g} Hz"


def _period(time: FloatArray, clock: str, notes: list[str]) -> float:
    period = usual_step(time[np.isfinite(time)])
    if not is_usual(period):
        notes.append(f"clock {clock}: rows are {period:.3g} s apart: is that its unit?")
    steps = np.diff(time)
    longest = longest_step(steps[np.isfinite(steps)], period)
    wide = steps[steps > longest]
    if len(wide) > UNEVEN * len(steps):
        came = f"steps of {np.min(steps[steps > 0.0]):.3g} to {np.max(wide):.3g} s"
        notes.append(f"clock {clock}: uneven, {came}; rows are read at even steps")
        return period
    if len(wide):
        notes.append(f"clock {clock}: {len(wide)} gaps, the longest of {np.max(wide):.4g} s")
    if np.any(steps <= 0.0):
        back = np.flatnonzero(steps <= 0.0)
        first = f"{time[back[0]]:.6g} to {time[back[0] + 1]:.6g} s behind row {back[0] + 1}"
        notes.append(f"clock {clock}: {len(back)} steps do not rise, the first from {first}")
    even = steps[(steps > 0.0) & (steps <= longest)]
    if len(even) and np.max(np.abs(even - period)) > JITTER * period:
        share = np.max(np.abs(even - period)) / period
        notes.append(f"clock {clock}: steps jitter by {share:.0%}, rows are read at even steps")
    return period


def _sorted(
    columns: Sequence[Column],
    read: Mapping[str, FloatArray],
    clock: str,
    scale: float,
    period: float,
    path: Path,
    notes: list[str],
) -> LogColumns:
    """Columns by what can be done with them: the longest stretch that all fill, at even steps."""
    rows = len(next(iter(read.values())))
    time = scale * read[clock] if clock else period * np.arange(rows)
    known = np.isfinite(time)
    good = known & np.concatenate([[True], np.diff(time) > 0.0])
    full = {n: np.isfinite(v) for n, v in read.items() if n != clock}
    empty = [n for n, finite in full.items() if np.mean(finite) < FILLED]
    kept = {n: finite | lone(~finite) for n, finite in full.items() if n not in empty}
    broken = np.concatenate([[False], np.diff(time) > (FEW + GAP) * period])
    longest = longest_step(np.diff(time[known]), period)
    broken &= np.count_nonzero(np.diff(time) > longest) <= UNEVEN * rows
    stretch, window = _longest(np.all([*kept.values()] or [good], axis=0), broken), None
    count = np.count_nonzero(~np.all([full[n][stretch] for n in kept] or [good[stretch]], axis=0))
    if count:
        notes.append(f"{count} rows lack a number: it is taken straight between its neighbours")
    if stretch != slice(0, rows):
        ends = time[known & (np.arange(rows) >= stretch.start) & (np.arange(rows) < stretch.stop)]
        window = (float(ends[0] - time[known][0]), float(ends[-1] - time[known][0]))
        notes.append(
            f"longer stretches without rows or numbers: window {window[0]:g} to {window[1]:g} s,"
            " the longest without any, is used"
        )
    own = time[stretch][good[stretch]]
    even = own[0] + period * np.arange(int((own[-1] - own[0]) / period + 1.0 + 1e-6))
    used = {n: filled(read[n][stretch], ~full[n][stretch], held=False)[good[stretch]] for n in kept}
    units = {c.name: c.unit for c in columns}
    for name in used:
        used[name] = _without_wraps(name, used[name], units.get(name, ""), notes)
    constant = [n for n, v in used.items() if np.ptp(v) == 0.0]
    values = {n: np.asarray(np.interp(even, own, v)) for n, v in used.items() if n not in constant}
    if not values or len(even) < FEWEST:
        groups = (("constant", constant), ("with gaps", empty))
        came = "; ".join(f"{word}: {_few(names)}" for word, names in groups if names)
        expected = "columns of numbers that change"
        some = len(empty) > 1 and all(np.any(full[n]) for n in empty)
        if some and not np.any(np.all([full[n] for n in empty], axis=0)):
            expected += "; no row holds all of them: signals of several clocks, as a player of"
            expected += " messages exports them, are put on one clock by ves-twin import --map"
        raise InvalidInputError(f"columns of {path.name}", came or "none", expected)
    told = tuple(constant), tuple(empty), tuple(notes)
    called = {c.name: c.said for c in columns if c.said and c.name in used}
    steady = {n: np.full(len(even), used[n][0]) for n in constant if used[n][0] != 0.0}
    found = LogColumns(path.name, clock, scale, period, values, units, *told, window, used, called)
    slower = {n: (v, repeats(v)) for n, v in used.items()}
    return replace(
        found,
        steady=steady,
        stamps=own,
        slower={
            n: Readings(most, np.interp(even, own, unheld(v, most)), v[read_at(v, most)])
            for n, (v, most) in slower.items()
            if most > 1
        },
    )


def _few(names: list[str]) -> str:
    """Some names, and how many more there are."""
    more = f" and {len(names) - FIRST} more" if len(names) > FIRST else ""
    return f"{', '.join(names[:FIRST])}{more}"


def _without_wraps(name: str, values: FloatArray, unit: str, notes: list[str]) -> FloatArray:
    """A column without the wraps of an angle, which `diagnose` takes out as well."""
    for turn in (turn for told, turn in TURNS.items() if unit in ("", told)):
        found, wraps = unwrapped(values, turn)
        if wraps:
            notes.append(f"{name} wraps {wraps} times: whole turns are added")
            return found
    return values


def _longest(good: BoolArray, broken: BoolArray) -> slice:
    """The longest stretch of good rows; none goes across a row that is broken from the last one."""
    before = np.concatenate([[False], good[:-1]]) & ~broken
    starts = np.flatnonzero(good & ~before)
    if not len(starts):
        return slice(0, 0)
    counts = np.bincount(np.cumsum(good & ~before)[good] - 1)
    at = int(np.argmax(counts))
    return slice(int(starts[at]), int(starts[at] + counts[at]))
