"""table: a recording's rows as Arrow columns, with unit, frame and role of each column."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping

import numpy as np
import pyarrow as pa

from ves_twin.core.errors import InvalidInputError, UnknownNameError, one_line
from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.core.types import FloatArray

KEY = b"ves_twin"
"""Key of the schema metadata that holds the RecordingInfo as JSON."""


def schema_of(names: Iterable[str], info: RecordingInfo) -> pa.Schema:
    """Columns `t` and those of the named signals, numbered from 1; metadata on each."""
    columns = [pa.field("t", pa.float64(), metadata={"unit": "s"})]
    for name in names:
        signal = info.signal(name)
        for column, axis, unit in zip(signal.columns, signal.axes, signal.units, strict=True):
            metadata = {
                "signal": name,
                "axis": axis,
                "unit": unit,
                "frame": signal.frame,
                "role": signal.role.value,
                "meaning": signal.meaning,
            }
            if name in info.held:
                metadata["held"] = f"{info.held[name]:.9g}"
            columns.append(pa.field(column, pa.float64(), metadata=metadata))
    return pa.schema(columns, metadata={KEY: json.dumps(info.to_dict()).encode()})


def batch_of(
    schema: pa.Schema, time: FloatArray, signals: Mapping[str, FloatArray]
) -> pa.RecordBatch:
    """Rows as a record batch of a schema; signals (n, width) in the schema's order."""
    arrays = [pa.array(time)]
    for values in signals.values():
        arrays += [pa.array(np.ascontiguousarray(values[:, i])) for i in range(values.shape[1])]
    return pa.record_batch(arrays, schema=schema)


def with_info(schema: pa.Schema, info: RecordingInfo) -> pa.Schema:
    """The schema with another RecordingInfo."""
    return schema.with_metadata({KEY: json.dumps(info.to_dict()).encode()})


def recording_of(table: pa.Table, where: object) -> Recording:
    """A recording from a table written by `schema_of` and `batch_of`.

    Raises:
        InvalidInputError: no column t, or columns that are not signals of ours.
    """
    metadata = table.schema.metadata or {}
    try:
        names = table.column_names
    except UnicodeDecodeError:
        names = []
    if "t" not in names or KEY not in metadata:
        raise InvalidInputError(str(where), "a table", "a recording written by ves-twin")
    try:
        info = RecordingInfo.from_dict(json.loads(metadata[KEY]))
    except (ValueError, TypeError, AttributeError) as error:
        raise InvalidInputError(
            f"metadata of {where}", str(error), "a ves-twin recording"
        ) from None
    try:
        return Recording(_column(table, "t"), _signals(table, info), info)
    except (KeyError, TypeError, ValueError, UnknownNameError, pa.ArrowException) as error:
        raise InvalidInputError(str(where), one_line(error), "a ves-twin recording") from None


def _signals(table: pa.Table, info: RecordingInfo) -> dict[str, FloatArray]:
    groups: dict[str, list[str]] = {}
    for column in table.column_names:
        if column != "t":
            metadata = table.schema.field(column).metadata or {}
            groups.setdefault(metadata.get(b"signal", b"").decode(), []).append(column)
    for name, columns in groups.items():
        if not name or tuple(columns) != info.signal(name).columns:
            raise ValueError(f"columns {', '.join(columns[:3])} are no signal of the recording")
    return {
        name: np.column_stack([_column(table, c) for c in columns])
        for name, columns in groups.items()
    }


def _column(table: pa.Table, name: str) -> FloatArray:
    column = table.column(name)
    if not pa.types.is_floating(column.type):
        raise ValueError(f"column {name} holds {column.type}, not numbers")
    return np.asarray(column.to_numpy(), dtype=float)
