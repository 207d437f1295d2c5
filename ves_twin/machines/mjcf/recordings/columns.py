"""read_rig_recording: a raw log as a recording, by the columns that a machine's file names."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.missing_file import missing_file
from ves_twin.core.recording.recording import POSES, Recording, RecordingInfo
from ves_twin.core.signals import Role
from ves_twin.core.types import BoolArray, FloatArray
from ves_twin.data.clock.clock_report import usual_step
from ves_twin.data.clock.unwrapped import unwrapped
from ves_twin.data.empty_cells import FEW, MOST, filled, lone
from ves_twin.data.formats.log import Kind, Log
from ves_twin.data.formats.open_log import open_log
from ves_twin.data.mapping.column_expression import ColumnExpression
from ves_twin.data.repeats import unheld
from ves_twin.machines.mjcf.parts.cyclic import turned_by
from ves_twin.machines.mjcf.parts.joint_units import joint_units
from ves_twin.machines.mjcf.parts.turned import turned
from ves_twin.machines.mjcf.recordings.signals import rig_signals
from ves_twin.machines.mjcf.rig.column import Column
from ves_twin.machines.mjcf.rig.description import Mode, RigDescription
from ves_twin.machines.mjcf.rig.machine import Rig

UNEVEN = 0.01
"""Largest departure of a time step from the mean that passes as an even clock."""

TWICE = 0.1
"""Share of rows that may have the stamp of the row before; of more the clock is too coarse, and the
recording is refused."""

HOLE = 5.0
"""Periods over which a line is drawn between two rows, that is over four rows that are not there;
a longer gap is left to be refused."""


def read_rig_recording(path: Path, rig: Rig) -> Recording:
    """A recording of a rig.

    Rows outside the file's `window` are left out before anything is refused. So are a few that have
    the stamp of the row before; a FEW rows together that lack a number are filled, and an angle
    that is told within one turn is unwrapped: all of it is said. Where stamps jitter by more than
    UNEVEN of a step, every signal is read at even rows: measurements straight between the rows,
    commands by their mean over each step.

    Args:
        path: of any format that `ves-twin inspect` reads.
        rig: whose signals are read.

    Raises:
        FileAccessError: missing file.
        UnknownNameError: a column that is not there; says the nearest one.
        InvalidInputError: no table, no rows, more rows together without a number, or time that
            steps back.
    """
    if not path.is_file():
        raise missing_file("recording", path)
    told = rig.description
    table = _Table.of(open_log(path), told)
    time, inside = _times(table, told, path)
    poses = told.clock.poses
    twice = inside & _again(time)
    few = 0 < np.count_nonzero(twice) <= TWICE * np.count_nonzero(inside) and not poses
    inside = inside & ~twice if few else inside
    empty = np.zeros(table.rows, bool) if poses else _lacking(table, told, inside)
    time, signals, said = time[inside], dict[str, FloatArray](), list[str]()
    if few:
        words = f"{path.name}: rows with the stamp of the row before are left out"
        said.append(f"{words}: {np.count_nonzero(twice)}")
    for name, column in told.signals.items():
        whole = [table.column(c, inside, path, held(rig, name), poses) for c in column.columns]
        signals[name] = _value(column, whole, time)
        if not poses and _turns(rig, name):
            angle, wraps = unwrapped(signals[name][:, 0], 2.0 * np.pi)
            signals[name] = angle[:, None]
            said += [f"{path.name}: {name} wraps {wraps} times: whole turns are added"] * (
                wraps > 0
            )
        repeats = 1 if column.integrated else column.repeats
        read = [unheld(values, repeats) for values in signals[name].T]
        signals[name] = np.stack(read, axis=1)
    for name, column in told.signals.items():
        if column.into:
            signals[name] = turned(signals[name], signals, name, column.into)
    log = POSES if poses else ""
    info = RecordingInfo("measured", scenario=path.stem, log=log, outcome="finished")
    if empty.any():
        count = f"{path.name}: {np.count_nonzero(empty)} rows lack a number"
        words = f"{count}: measurements are taken straight between rows, commands as before"
        said.append(words)
    if said:
        info = replace(info, imported={"suspected": said})
    if poses:
        return Recording(time, signals, info)
    return _even(Recording(time, signals, info), rig)


def _value(column: Column, read: Sequence[FloatArray], time: FloatArray) -> FloatArray:
    """A signal (n, w) of the columns behind it (n,)."""
    if not column.integrated:
        return np.asarray(column.scale * np.stack(read, axis=1) + column.offset)
    (speed,) = read
    angle = turned_by(column.scale * unheld(speed, column.repeats), time)
    return np.asarray(angle[:, None] + column.offset)


def _turns(rig: Rig, signal: str) -> bool:
    """Whether a signal is the angle of a joint."""
    one = rig.description.signals[signal]
    told = one.of == "position" and not one.integrated
    if not one.joint or not told or len(one.columns) != 1 or one.into:
        return False
    return joint_units(rig.model, one.joint)[0] == "rad"


@dataclass(frozen=True)
class _Table:
    """Columns of one table of a log."""

    rows: int
    columns: Mapping[str, FloatArray]

    @staticmethod
    def of(log: Log, told: RigDescription) -> _Table:
        """Those that a description names, by themselves or in formulas."""
        known = log.full_names()
        asked = [c for one in told.signals.values() for c in one.columns]
        names = [name for text in asked for name in needed(text, known)]
        names += [told.clock.column] if told.clock.column else []
        for name in names:
            if name not in known:
                raise UnknownNameError(f"column of {log.path.name}", name, known)
            if known[name][1].kind is Kind.TEXT:
                raise InvalidInputError(f"column {name} of {log.path.name}", "a text", "numbers")
        tables = sorted({known[name][0].name for name in names})
        if len(tables) > 1:
            expected = "columns of one table; a map (--map) puts several onto one clock"
            raise InvalidInputError(f"columns of {log.path.name}", f"tables {tables}", expected)
        own = {name: known[name][1].name for name in names}
        read = log.read(tables[0], list(dict.fromkeys(own.values())))
        rows = min((len(values) for values in read.values()), default=0)
        if rows == 0:
            raise InvalidInputError(str(log.path), "0 rows", "a recording")
        return _Table(rows, {name: read[column] for name, column in own.items()})

    def all_of(self, text: str) -> FloatArray:
        """A column or a formula of columns in every row, NaN where a cell is empty."""
        values = self.columns.get(text)
        if values is None:
            values = ColumnExpression(text).value(self.columns)
        return np.asarray(np.broadcast_to(values, self.rows))

    def column(
        self, text: str, inside: BoolArray, path: Path, hold: bool = False, strict: bool = False
    ) -> FloatArray:
        """The same in some rows (n,), a FEW together without a number filled; none if strict."""
        values = self.all_of(text)
        empty = inside & ~np.isfinite(values)
        few = lone(empty) & (np.mean(empty[inside]) <= MOST) & (not strict)
        bad = np.flatnonzero(empty & ~few)
        if len(bad):
            came = f"{len(bad)} empty rows, the first is row {bad[0] + 1} of the table"
            expected = f"numbers, or {FEW} empty rows together and {MOST:.0%} in all at most"
            where = f"column {text} of {path.name}"
            advice = f"{expected}; window in the machine's file leaves a stretch out"
            raise InvalidInputError(where, came, advice)
        return filled(values[inside], empty[inside], hold)


def needed(text: str, known: Mapping[str, object]) -> tuple[str, ...]:
    """Columns behind a text: the column of that name, else those of a formula.

    Raises:
        InvalidInputError: no formula either, in a text with signs of one.
    """
    if text in known or not any(sign in text for sign in "+-*/(`"):
        return (text,)
    return ColumnExpression(text).columns


def _times(table: _Table, told: RigDescription, path: Path) -> tuple[FloatArray, BoolArray]:
    """Times of all rows [s], and which of them are in the window."""
    clock, whole = told.clock, np.ones(table.rows, dtype=bool)
    if clock.column:
        time = clock.scale * table.column(clock.column, whole, path, strict=clock.poses)
    else:
        time = np.asarray(np.arange(table.rows) / clock.rate, np.float64)
    since = time - time[0]
    inside = (since >= told.window.start - 1e-9) & (since < told.window.stop - 1e-9)
    if not inside.any():
        came = f"{told.window.start:g} to {told.window.stop:g} s"
        raise InvalidInputError("window", came, f"a stretch of 0 to {since[-1]:.4g} s")
    return time, inside


def _again(time: FloatArray) -> BoolArray:
    """Rows (n,) that have the stamp of the row before."""
    return np.concatenate([[False], np.diff(time) == 0.0])


def _lacking(table: _Table, told: RigDescription, inside: BoolArray) -> BoolArray:
    """Rows of the window in which a column that is used lacks a number."""
    names = [name for one in told.signals.values() for name in one.columns]
    names += [told.clock.column] if told.clock.column else []
    whole = np.all([np.isfinite(table.all_of(name)) for name in names], axis=0)
    return np.asarray(inside & ~whole)


def _even(recording: Recording, rig: Rig) -> Recording:
    """With times of an even clock that rounding or jitter made uneven."""
    time = recording.time
    steps = np.diff(time)
    if not len(steps) or np.ptp(steps) == 0.0:
        return recording
    if np.ptp(steps) <= UNEVEN * np.mean(steps):
        return replace(recording, time=np.linspace(time[0], time[-1], len(time)))
    period = usual_step(time)
    if np.max(steps) > (HOLE + 0.5) * period:  # whoever needs even rows says so
        return recording
    rows = np.asarray(time[0] + period * np.arange(int((time[-1] - time[0]) / period) + 1))
    read = {
        name: np.stack([_at(rows, c, time, held(rig, name)) for c in values.T], axis=1)
        for name, values in recording.signals.items()
    }
    near = steps[steps < 1.5 * period]
    jitter = float(np.max(np.abs(near - period))) / period
    note = f"stamps jitter by up to {jitter:.0%}: read at even {1.0 / period:.5g} Hz"
    info = replace(recording.info, imported={**recording.info.imported, "notes": [note]})
    return Recording(rows, read, info)


def held(rig: Rig, signal: str) -> bool:
    """Whether a signal is a command that the machine held from one row to the next.

    Where motion is fed in, efforts are what is measured, and belong to the instant of the motion.
    """
    roles = {one.name: one.role for one in rig_signals(rig)}
    measured = rig.description.drive.mode is Mode.MOTION
    return roles.get(signal) is Role.COMMAND and not measured


def _at(rows: FloatArray, values: FloatArray, time: FloatArray, hold: bool) -> FloatArray:
    """A column at other times: straight between rows; of a held command its mean over each step.

    What a drive gives to the motion is the integral of its command: the nearest row was half a step
    early or late (a servo's set-points at 10 rad/s, stamps that jitter by a third of a step: twice
    the error of the right model).
    """
    if not hold:
        return np.asarray(np.interp(rows, time, values))
    step = float(rows[1] - rows[0]) if len(rows) > 1 else 1.0
    ends = np.append(time, max(time[-1], rows[-1]) + 2.0 * step)
    whole = np.concatenate([[0.0], np.cumsum(values * np.diff(ends))])
    return np.asarray(np.diff(np.interp(np.append(rows, rows[-1] + step), ends, whole)) / step)
