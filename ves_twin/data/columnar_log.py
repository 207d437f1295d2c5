"""ColumnarLog: Parquet, Arrow IPC files and Arrow streams, also a stream that was cut."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.ipc as ipc
import pyarrow.parquet as pq

from ves_twin.core.errors import InvalidInputError, one_line
from ves_twin.core.types import FloatArray
from ves_twin.data.csv_log import seconds_of
from ves_twin.data.log import Block, Column, Extremes, Kind, KnownRanges, Log, Table
from ves_twin.data.unit_names import spelled, unit_of_name

DAMAGE = (pa.ArrowException, OSError, MemoryError, ValueError)
"""What damaged files make the library raise: lengths beyond memory, names that are no text."""

ROWS = 1 << 16
"""Rows that are read at a time."""


class ParquetLog(Log):
    """A Parquet file; ranges come from its own statistics where it has them."""

    def __init__(self, path: Path) -> None:
        self._file, columns = _opened(path)
        table = Table("", columns, self._file.metadata.num_rows)
        super().__init__(path, "Parquet", [table])
        _note_texts(self)

    def blocks(self, table: str, columns: Sequence[str]) -> Iterator[Block]:
        """Batches of rows; a group that cannot be read is left out and named."""
        for group in range(self._file.num_row_groups):
            try:
                for batch in self._file.iter_batches(ROWS, [group], columns=list(columns)):
                    yield {n: numbers(batch.column(n)) for n in columns}
            except DAMAGE as error:
                rows = self._file.metadata.row_group(group).num_rows
                words = f"row group {group + 1} ({rows} rows): {one_line(error)}"
                self.note_fault(f"group {group}", words)

    def known_ranges(self, table: str) -> KnownRanges | None:
        """From the statistics of the row groups; None if a column of numbers lacks them."""
        found: dict[str, Extremes] = {}
        metadata = self._file.metadata
        for i, column in enumerate(self.tables[0].columns):
            if column.kind is not Kind.NUMBER:
                continue
            parts = [
                metadata.row_group(g).column(i).statistics for g in range(metadata.num_row_groups)
            ]
            if not parts or not all(p is not None and p.has_min_max for p in parts):
                return None
            low, high = min(p.min for p in parts), max(p.max for p in parts)
            found[column.name] = Extremes(float(low), float(high), None)
        return KnownRanges("the file's own statistics", found)


class ArrowLog(Log):
    """An Arrow stream, as a run writes while it lasts, or an Arrow IPC file (Feather)."""

    def __init__(self, path: Path) -> None:
        try:
            with path.open("rb") as file:
                self._is_file = file.read(6) == b"ARROW1"
            with pa.OSFile(str(path)) as source:
                columns = _columns(self._reader(source).schema)
        except DAMAGE as error:
            raise InvalidInputError(path.name, one_line(error), "a whole Arrow schema") from None
        super().__init__(path, "Arrow", [Table("", columns)])
        _note_texts(self)

    def _reader(self, source: pa.NativeFile) -> ipc.RecordBatchReader:
        return ipc.open_file(source) if self._is_file else ipc.open_stream(source)

    def blocks(self, table: str, columns: Sequence[str]) -> Iterator[Block]:
        """Whole batches; one that was cut ends the reading and is named."""
        rows = 0
        with pa.OSFile(str(self.path)) as source:
            reader = self._reader(source)
            number = 0
            while True:
                try:
                    if self._is_file:
                        if number == reader.num_record_batches:
                            return
                        batch = reader.get_batch(number)
                    else:
                        batch = reader.read_next_batch()
                except StopIteration:
                    return
                except DAMAGE as error:
                    self.note_fault("cut", f"cut after row {rows}: {one_line(error)}")
                    return
                number, rows = number + 1, rows + batch.num_rows
                yield {n: numbers(batch.column(n)) for n in columns}


def numbers(column: pa.Array) -> FloatArray:
    """A column as numbers, stamps as seconds since 1970, NaN where it holds nothing."""
    if pa.types.is_timestamp(column.type):
        return seconds_of(pa.chunked_array([column]))
    if pa.types.is_duration(column.type):
        column = column.cast(pa.duration("ns")).cast(pa.int64())
        return np.asarray(column.cast(pa.float64(), safe=False)) * 1e-9
    return np.asarray(column.cast(pa.float64(), safe=False).to_numpy(zero_copy_only=False))


def _opened(path: Path) -> tuple[pq.ParquetFile, tuple[Column, ...]]:
    try:
        file = pq.ParquetFile(path)
        return file, _columns(file.schema_arrow)
    except DAMAGE as error:
        reason = one_line(error)
        if "magic bytes" in reason or "footer" in reason.lower():
            reason = "cut: the footer at its end, without which no row can be found, is missing"
        raise InvalidInputError(path.name, reason, "a whole Parquet file") from None


def _columns(schema: pa.Schema) -> tuple[Column, ...]:
    found = []
    for field in schema:
        said = (field.metadata or {}).get(b"unit", b"").decode("utf-8", "replace")
        unit = spelled(said) or unit_of_name(field.name)
        kind, seconds = _kind(field.type)
        found.append(Column(field.name, "s" if seconds else unit, kind))
    return tuple(found)


def _kind(kind: pa.DataType) -> tuple[Kind, bool]:
    """What a type holds, and whether reading it makes seconds of it."""
    if pa.types.is_timestamp(kind):
        return Kind.STAMP, True
    if pa.types.is_duration(kind):
        return Kind.NUMBER, True
    types = pa.types
    number = types.is_floating(kind) or types.is_integer(kind) or types.is_boolean(kind)
    return (Kind.NUMBER if number else Kind.TEXT), False


def _note_texts(log: Log) -> None:
    texts = [c.name for c in log.tables[0].columns if c.kind is Kind.TEXT]
    if texts:
        log.note_fault("texts", f"no numbers, passed over: {', '.join(texts)}")
