"""write_tables: a finished sweep as one Parquet table, and its timing apart.

Wall-clock times differ from run to run; they lie in a file of their own, so that the table of the
same sweep is the same to the byte wherever it ran.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from ves_twin.core.signals import SIGNALS
from ves_twin.core.whole_file import whole_file
from ves_twin.scenario.fields import Part
from ves_twin.sweeps.key_value import Value
from ves_twin.sweeps.plan import SweepPlan
from ves_twin.sweeps.result import PointResult

TABLE_NAME = "sweep.parquet"
TIMING_NAME = "timing.parquet"
KEY = b"ves_twin.sweep"
"""Key of the metadata that holds the identity as JSON."""

_Column = tuple[pa.Field, pa.Array]


def write_tables(folder: Path, plan: SweepPlan, results: Mapping[int, PointResult]) -> Path:
    """Write `sweep.parquet` and `timing.parquet`; every point has a row.

    Raises:
        FileAccessError: they cannot be written.
    """
    rows = [results[point.number] for point in plan.points]
    timing = [
        _column("point", pa.int64(), [row.number for row in rows]),
        _column("seconds", pa.float64(), [row.seconds for row in rows], "s", "wall-clock time"),
        _column("host", pa.string(), [row.host for row in rows], "", "machine and process"),
    ]
    _write(folder / TIMING_NAME, timing, {})
    metadata = {KEY: json.dumps(plan.identity, sort_keys=True).encode()}
    columns = [*_settings(plan), *_outcomes(plan, rows), *_errors(rows), *_tracking(rows)]
    _write(folder / TABLE_NAME, columns, metadata)
    return folder / TABLE_NAME


def _settings(plan: SweepPlan) -> list[_Column]:
    columns = [_column("point", pa.int64(), [point.number for point in plan.points])]
    for i, (key, unit) in enumerate(plan.keys.items()):
        values = [point.values[i] for point in plan.points]
        columns.append(_column(key, _kind(values), _like(values), unit, "varied"))
    if "run.seed" not in plan.keys:
        seeds = [point.scenario.run.seed for point in plan.points]
        columns.append(_column("run.seed", pa.int64(), seeds, "", "seed of the noise"))
    return columns


def _outcomes(plan: SweepPlan, rows: Sequence[PointResult]) -> list[_Column]:
    hashes = [point.plant_hash for point in plan.points]
    return [
        _column("outcome", pa.string(), [row.outcome for row in rows]),
        _column("reason", pa.string(), [row.reason for row in rows]),
        _column("duration", pa.float64(), [row.duration for row in rows], "s", "simulated time"),
        _column("plant_hash", pa.string(), hashes, "", "numbers and parts of the rig"),
        _column("run_id", pa.string(), [row.run_id for row in rows], "", "all that went in"),
        _column("run_hash", pa.string(), [row.run_hash for row in rows], "", "all that came out"),
    ]


def _errors(rows: Sequence[PointResult]) -> list[_Column]:
    """Emulation error of each axis; nothing where no point has a reference."""
    parts = ("rms", "peak", "relative", "rms_rest")
    return _by_axis("error", parts, [row.emulation_error for row in rows])


def _tracking(rows: Sequence[PointResult]) -> list[_Column]:
    """Tracking error of each axis; nothing where every point emulates a base."""
    return _by_axis("tracking", ("rms", "peak", "relative"), [row.tracking_error for row in rows])


def _by_axis(
    prefix: str, parts: Sequence[str], rows: Sequence[Mapping[str, Part]]
) -> list[_Column]:
    if not any(rows):
        return []
    pose = SIGNALS["truth.pose"]
    columns = []
    for axis, unit in zip(pose.axes, pose.units, strict=True):
        found = [row.get(axis) for row in rows]
        for name in parts:
            values = [None if error is None else getattr(error, name) for error in found]
            shown = "dimensionless" if name == "relative" else unit
            columns.append(_column(f"{prefix}.{axis}.{name}", pa.float64(), values, shown))
    return columns


def _kind(values: Sequence[Value]) -> pa.DataType:
    """The narrowest type that holds every value of a key."""
    given = [value for value in values if value is not None]
    for python, arrow in ((bool, pa.bool_()), (int, pa.int64()), (float, pa.float64())):
        right = [type(value) is python or (python is float and _whole(value)) for value in given]
        if given and all(right):
            return arrow
    if given and all(isinstance(value, list) for value in given):
        return pa.list_(pa.float64())
    return pa.string()


def _whole(value: Value) -> bool:
    return type(value) is int


def _like(values: Sequence[Value]) -> Sequence[Value]:
    """The values, as texts where a key took values of several types."""
    if _kind(values) != pa.string():
        return values
    return [v if v is None or isinstance(v, str) else json.dumps(v) for v in values]


def _column(
    name: str, kind: pa.DataType, values: Iterable[Value], unit: str = "", meaning: str = ""
) -> _Column:
    metadata = {key: text for key, text in (("unit", unit), ("meaning", meaning)) if text}
    return pa.field(name, kind, metadata=metadata or None), pa.array(list(values), kind)


def _write(path: Path, columns: Sequence[_Column], metadata: Mapping[bytes, bytes]) -> None:
    schema = pa.schema([field for field, _ in columns], metadata=metadata)
    table = pa.Table.from_arrays([array for _, array in columns], schema=schema)
    with whole_file(path) as partial, partial.open("wb") as file:
        pq.write_table(table, file, compression="zstd")
