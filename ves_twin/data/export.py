"""export_recording: a recording as CSV, Parquet or MAT, units kept."""

from __future__ import annotations

import json
from pathlib import Path

import pyarrow as pa
import pyarrow.csv as pcsv
import scipy.io

from ves_twin.core.errors import UnknownNameError
from ves_twin.core.recording.files import save_recording
from ves_twin.core.recording.recording import Recording
from ves_twin.core.recording.table import batch_of, schema_of
from ves_twin.core.whole_file import whole_file, write_whole

FORMATS = ("csv", "parquet", "mat")


def export_recording(recording: Recording, form: str, path: Path) -> tuple[Path, ...]:
    """Write a recording for other programs; files appear when they are whole.

    CSV: one header line, `leg.length.1 [m]`, and a sidecar FILE.json with every column's unit,
    frame and role and the recording's origin. MAT (v5): `t`, a matrix (n, width) for each signal
    with `_` for `.`, `units` by column, and the same JSON as text `ves_twin`. Numbers come back to
    the last bit.

    Args:
        recording: simulated or measured.
        form: csv, parquet or mat.
        path: of the file.

    Returns:
        The files written.

    Raises:
        UnknownNameError: another format.
        FileAccessError: a folder that cannot be written.
    """
    if form not in FORMATS:
        raise UnknownNameError("format", form, FORMATS)
    if form == "parquet":
        save_recording(recording, path)
        return (path,)
    return _csv(recording, path) if form == "csv" else _mat(recording, path)


def _csv(recording: Recording, path: Path) -> tuple[Path, ...]:
    schema = schema_of(recording.signals, recording.info)
    batch = batch_of(schema, recording.time, recording.signals)
    table = pa.Table.from_batches([batch])
    names = [f"{field.name} [{_unit(field)}]" for field in schema]
    sidecar = path.with_name(f"{path.name}.json")
    with whole_file(path) as partial:
        with partial.open("wb") as file:
            file.write((",".join(names) + "\n").encode())
            options = pcsv.WriteOptions(include_header=False)
            pcsv.write_csv(table.replace_schema_metadata(None), file, options)
        write_whole(sidecar, json.dumps(_metadata(recording, schema), indent=1))
    return path, sidecar


def _mat(recording: Recording, path: Path) -> tuple[Path, ...]:
    schema = schema_of(recording.signals, recording.info)
    content: dict[str, object] = {"t": recording.time[:, None]}
    units = {"t": "s"}
    for name, values in recording.signals.items():
        signal = recording.info.signal(name)
        variable = f"{signal.field}_" if signal.field in content else signal.field  # t is the time
        content[variable] = values
        columns = _mat_columns(variable, signal.width)
        units |= dict(zip(columns, signal.units, strict=True))
    content["units"] = {key.replace(".", "_"): unit for key, unit in units.items()}
    content["ves_twin"] = json.dumps(_metadata(recording, schema))
    with whole_file(path) as partial, partial.open("wb") as file:
        scipy.io.savemat(file, content, long_field_names=True, do_compression=True)
    return (path,)


def _mat_columns(field: str, width: int) -> list[str]:
    return [field] if width == 1 else [f"{field}.{i + 1}" for i in range(width)]


def _metadata(recording: Recording, schema: pa.Schema) -> dict[str, object]:
    columns = {
        field.name: {k.decode(): v.decode() for k, v in (field.metadata or {}).items()}
        for field in schema
    }
    return {"columns": columns, "info": recording.info.to_dict()}


def _unit(field: pa.Field) -> str:
    return str((field.metadata or {}).get(b"unit", b"").decode())
