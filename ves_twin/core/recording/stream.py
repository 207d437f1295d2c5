"""RecordingStream: rows go to an Arrow IPC stream while a run lasts, then into Parquet.

A stream that was cut by a kill is readable up to its last whole batch.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from contextlib import suppress
from pathlib import Path

import pyarrow as pa
import pyarrow.ipc as ipc
import pyarrow.parquet as pq

from ves_twin.core.errors import FileAccessError
from ves_twin.core.recording.recording import RecordingInfo
from ves_twin.core.recording.stream_batches import CHECKSUM, batch_checksum, stream_batches
from ves_twin.core.recording.table import batch_of, schema_of, with_info
from ves_twin.core.types import FloatArray
from ves_twin.core.whole_file import whole_file

STREAM_NAME = "recording.arrows"
FILE_NAME = "recording.parquet"


class RecordingStream:
    """Writes batches of rows to `recording.arrows` in a folder; memory stays bounded."""

    def __init__(self, folder: Path, names: tuple[str, ...], info: RecordingInfo) -> None:
        self._folder = folder
        self._schema = schema_of(names, info)
        self._path = folder / STREAM_NAME
        try:
            if self._path.exists():  # rows of a run that was killed are not ours to drop
                self._path.rename(_free(folder, f"previous-{STREAM_NAME}"))
            self._file = self._path.open("w+b")
        except OSError as error:
            raise FileAccessError(f"cannot write {self._path}: {error.strerror}") from None
        try:
            self._writer = ipc.new_stream(self._file, self._schema)
            self._file.flush()
        except OSError as error:
            with suppress(OSError):
                self._file.close()
            self._path.unlink()
            raise FileAccessError(f"cannot write {self._path}: {error.strerror}") from None

    def write(self, time: FloatArray, signals: Mapping[str, FloatArray]) -> None:
        """Append rows and hand them to the operating system."""
        try:
            batch = batch_of(self._schema, time, signals)
            self._writer.write_batch(batch, {CHECKSUM: batch_checksum(batch)})
            self._file.flush()
        except OSError as error:
            raise FileAccessError(
                f"cannot write {self._path}: {error.strerror}; the rows before are kept"
            ) from None

    def finish(self, info: RecordingInfo) -> Path:
        """End the stream, write `recording.parquet` batch by batch, remove the stream.

        It reads the file that it opened, whatever has that name by now.

        Args:
            info: the final account of the run, with outcome and events.

        Returns:
            Path of the Parquet file.
        """
        self._end()
        target = self._folder / FILE_NAME
        schema = with_info(self._schema, info)
        try:
            with (
                whole_file(target) as partial,
                partial.open("wb") as file,  # pyarrow takes names of files in UTF-8 alone
                pq.ParquetWriter(file, schema, compression="zstd") as writer,
            ):
                for table in _grouped(stream_batches(self._file, self._path), schema):
                    writer.write_table(table)
        except FileAccessError as error:
            raise FileAccessError(f"{error}; rows kept in {self._path}") from None
        with suppress(OSError):
            if os.path.samestat(os.fstat(self._file.fileno()), self._path.stat()):
                self._path.unlink()
        self._file.close()
        return target

    def close(self) -> None:
        """Close the stream file; what was written stays."""
        if self._file.closed:
            return
        try:
            self._end()
        finally:
            with suppress(OSError):
                self._file.close()

    def _end(self) -> None:
        """Write what ends the stream."""
        try:
            self._writer.close()
            self._file.flush()
        except OSError as error:
            raise FileAccessError(
                f"cannot write {self._path}: {error.strerror or error}; the rows before are kept"
            ) from None

    def __enter__(self) -> RecordingStream:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()


def _free(folder: Path, name: str) -> Path:
    """The name, or the first of name-2, name-3, ... that is free."""
    path, number = folder / name, 1
    while path.exists():
        number += 1
        path = folder / f"{Path(name).stem}-{number}{Path(name).suffix}"
    return path


ROW_GROUP = 20_000
"""Rows of one Parquet row group: a few megabytes at the width of a recording."""


def _grouped(batches: Iterator[pa.RecordBatch], schema: pa.Schema) -> Iterator[pa.Table]:
    """Tables of exactly ROW_GROUP rows, whatever batches the rows came in."""
    held: list[pa.RecordBatch] = []
    rows = 0
    for batch in batches:
        held.append(batch)
        rows += batch.num_rows
        while rows >= ROW_GROUP:
            table = pa.Table.from_batches(held).replace_schema_metadata(schema.metadata)
            yield table.slice(0, ROW_GROUP)
            held = table.slice(ROW_GROUP).to_batches()
            rows -= ROW_GROUP
    if rows:
        yield pa.Table.from_batches(held).replace_schema_metadata(schema.metadata)
