"""table: a recording's rows as Arrow columns, with unit, frame and role of each column."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping

import numpy as np
import pyarrow as pa

from ves_twin.errors import InvalidInputError
from ves_twin.recording.recording import Recording, RecordingInfo
from ves_twin.signals import SIGNALS
from ves_twin.types import FloatArray

KEY = b"ves_twin"
"""Key of the schema metadata that holds the RecordingInfo as JSON."""


def schema_of(names: Iterable[str], info: RecordingInfo) -> pa.Schema:
    """Columns `t` and those of the named signals, numbered from 1; metadata on each."""
    columns = [pa.field("t", pa.float64(), metadata={"unit": "s"})]
    for name in names:
        signal = SIGNALS[name]
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
    if "t" not in table.column_names or KEY not in metadata:
        raise InvalidInputError(str(where), "a table", "a recording written by ves-twin")
    try:
        info = RecordingInfo.from_dict(json.loads(metadata[KEY]))
    except (ValueError, TypeError) as error:
        raise InvalidInputError(
            f"metadata of {where}", str(error), "a ves-twin recording"
        ) from None
    groups: dict[str, list[str]] = {}
    for column in table.column_names[1:]:
        signal = (table.schema.field(column).metadata or {}).get(b"signal", b"").decode()
        groups.setdefault(signal or column, []).append(column)
    signals = {
        name: np.column_stack([table.column(c).to_numpy() for c in columns])
        for name, columns in groups.items()
    }
    return Recording(table.column("t").to_numpy(), signals, info)
