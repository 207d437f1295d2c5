"""load_recording: a recording from Parquet, from an unfinished stream, or from a run's folder."""

from __future__ import annotations

from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from ves_twin.core.arrow_file import arrow_file
from ves_twin.core.errors import FileAccessError, InvalidInputError
from ves_twin.core.missing_file import missing_file
from ves_twin.core.recording.recording import Recording
from ves_twin.core.recording.stream import FILE_NAME, ROW_GROUP, STREAM_NAME
from ves_twin.core.recording.stream_batches import stream_batches
from ves_twin.core.recording.table import KEY, batch_of, recording_of, schema_of
from ves_twin.core.whole_file import whole_file


def load_recording(path: str | Path) -> Recording:
    """Read a recording.

    Args:
        path: a .parquet file, a .arrows stream (also one that a kill has cut), or the output
            folder of a run.

    Raises:
        FileAccessError: missing, unreadable, or without a row.
        InvalidInputError: not a recording of ours.
    """
    file = Path(path)
    if file.is_dir():
        names = [file / name for name in (STREAM_NAME, FILE_NAME)]  # a stream is the newer run
        found = [name for name in names if name.is_file()]
        if not found:
            raise FileAccessError(f"folder {file} holds neither {FILE_NAME} nor {STREAM_NAME}")
        file = found[0]
    if not file.is_file():
        raise missing_file("recording", file)
    return recording_of(_table(file), file)


def recording_name(path: str | Path) -> str:
    """What a recording is called: its file, or the folder of the run that the file lies in."""
    file = Path(path)
    own = file.name in {FILE_NAME, STREAM_NAME}
    return file.parent.name if own and file.parent.name else file.name


def is_recording(path: str | Path) -> bool:
    """Whether a path is a recording of ours, by its metadata, or a run's folder or stream."""
    file = Path(path)
    if file.is_dir() or file.suffix == ".arrows":
        return True
    if file.suffix != ".parquet" or not file.is_file():
        return False
    try:
        with arrow_file(file) as opened:
            return KEY in (pq.read_schema(opened).metadata or {})
    except (pa.ArrowInvalid, OSError):
        return False  # whoever reads it says what is wrong


def save_recording(recording: Recording, path: Path) -> None:
    """Write a recording to a Parquet file; the file appears when it is whole."""
    schema = schema_of(recording.signals, recording.info)
    table = pa.Table.from_batches([batch_of(schema, recording.time, recording.signals)])
    with whole_file(path) as partial, partial.open("wb") as file:
        pq.write_table(table, file, compression="zstd", row_group_size=ROW_GROUP)


def _table(file: Path) -> pa.Table:
    if file.suffix == ".arrows":
        try:
            with file.open("rb") as opened:
                batches = list(stream_batches(opened, file))
        except OSError as error:
            raise FileAccessError(f"recording {file}: {error.strerror}") from None
        if not batches:
            raise FileAccessError(f"recording {file} holds no whole batch of rows")
        return pa.Table.from_batches(batches)
    try:
        with arrow_file(file) as opened:
            return pq.read_table(opened)
    except (pa.ArrowInvalid, OSError) as error:
        reason = str(error).split("\n", 1)[0]
        wanted = (
            "a Parquet recording; `ves-twin import` makes one of a log, --plant FILE names the"
            " machine whose file reads it"
        )
        raise InvalidInputError(str(file), reason, wanted) from None
