"""read_rig_recording: a CSV or Parquet file as a recording, by the columns a rig names."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.csv as pacsv
import pyarrow.parquet as pq

from ves_twin.core.arrow_file import arrow_file
from ves_twin.core.errors import FileAccessError, InvalidInputError, UnknownNameError
from ves_twin.core.recording.recording import POSES, Recording, RecordingInfo
from ves_twin.core.types import FloatArray
from ves_twin.machines.mjcf.description import Column
from ves_twin.machines.mjcf.machine import Rig
from ves_twin.machines.mjcf.turned import turned
from ves_twin.scenario.columns import QUOTED_ROW

UNEVEN = 0.01
"""Largest departure of a time step from the mean that passes as an even clock."""


def read_rig_recording(path: Path, rig: Rig) -> Recording:
    """A recording of a rig.

    Args:
        path: .csv with a header line, or .parquet.
        rig: whose signals are read.

    Raises:
        FileAccessError: missing file.
        UnknownNameError: a column that is not there; says the nearest one.
        InvalidInputError: no table, no rows, text among numbers, or time that steps back.
    """
    if not path.is_file():
        raise FileAccessError(f"recording file '{path}' does not exist")
    told = rig.description
    table = _table(path)
    if len(table) == 0:
        raise InvalidInputError(str(path), "0 rows", "a recording")
    time = told.clock.scale * _column(table, told.clock.column, path)
    signals = {name: _signal(table, c, path) for name, c in told.signals.items()}
    for name, column in told.signals.items():
        if column.into:
            signals[name] = turned(signals[name], signals, name, column.into)
    log = POSES if told.clock.poses else ""
    info = RecordingInfo("measured", scenario=path.stem, log=log, outcome="finished")
    return Recording(time if told.clock.poses else _even(time), signals, info)


def _even(time: FloatArray) -> FloatArray:
    """Times of an even clock that rounding or jitter below 1 % of a step made uneven."""
    steps = np.diff(time)
    if len(steps) and np.ptp(steps) > 0.0 and np.ptp(steps) <= UNEVEN * np.mean(steps):
        return np.linspace(time[0], time[-1], len(time))
    return time


def _table(path: Path) -> pa.Table:
    try:
        with arrow_file(path) as file:
            return pq.read_table(file) if path.suffix == ".parquet" else pacsv.read_csv(file)
    except (pa.ArrowInvalid, OSError, csv.Error) as error:
        reason = QUOTED_ROW.sub(r"\1", str(error).split("\n", 1)[0])
        raise InvalidInputError(str(path), reason, "a CSV file with a header, or Parquet") from None


def _column(table: pa.Table, name: str, path: Path) -> FloatArray:
    if name not in table.column_names:
        raise UnknownNameError(f"column of {path.name}", name, table.column_names)
    column = table.column(name)
    if not (pa.types.is_floating(column.type) or pa.types.is_integer(column.type)):
        raise InvalidInputError(f"column {name} of {path.name}", str(column.type), "numbers")
    values = np.array(column.to_numpy(), dtype=float)
    bad = int(np.count_nonzero(~np.isfinite(values)))
    if bad:
        raise InvalidInputError(f"column {name} of {path.name}", f"{bad} empty rows", "numbers")
    return values


def _signal(table: pa.Table, told: Column, path: Path) -> FloatArray:
    columns = [_column(table, name, path) for name in told.columns]
    return np.asarray(told.scale * np.stack(columns, axis=1) + told.offset)
