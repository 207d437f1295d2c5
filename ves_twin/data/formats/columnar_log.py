"""ColumnarLog: Parquet, Arrow IPC files and Arrow streams, also a stream that was cut."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.ipc as ipc
import pyarrow.parquet as pq

from ves_twin.core.arrow_file import arrow_file
from ves_twin.core.errors import InvalidInputError, one_line
from ves_twin.core.types import FloatArray
from ves_twin.data.formats.csv_log import TICKS, seconds_of
from ves_twin.data.formats.limits import Limits
from ves_twin.data.formats.log import (
    Block,
    Column,
    Extremes,
    Kind,
    KnownRanges,
    Log,
    Table,
    unique_names,
)  # fmt: skip
from ves_twin.data.formats.unit_names import spelled, unit_of_name

DAMAGE = (pa.ArrowException, OSError, MemoryError, ValueError)
"""What damaged files make the library raise: lengths beyond memory, names that are no text."""

ROWS = 1 << 16
"""Rows that are read at a time."""


class ParquetLog(Log):
    """A Parquet file; ranges come from its own statistics where it has them."""

    def __init__(self, path: Path, limits: Limits | None = None) -> None:
        self._file, columns = _opened(path)
        table = Table("", columns, self._file.metadata.num_rows)
        super().__init__(path, "Parquet", [table], limits)
        fields = list(self._file.schema_arrow)
        first = np.cumsum([0, *(_leaves(field.type) for field in fields)])
        self._places = {c.name: int(at) for c, at in zip(columns, first[:-1], strict=True)}
        self._types = {c.name: field.type for c, field in zip(columns, fields, strict=True)}
        for group in range(self._file.num_row_groups):
            self.limits.check_unfolded(path, self._file.metadata.row_group(group).total_byte_size)
        _note_texts(self)

    def blocks(self, table: str, columns: Sequence[str]) -> Iterator[Block]:
        """Batches of rows; a group that cannot be read is left out and named."""
        order = sorted(columns, key=self._places.__getitem__)
        places = [self._places[name] for name in order]
        for group in range(self._file.num_row_groups):
            try:
                # by place: a name may stand for several columns, or be the begin of another
                for batch in self._file.reader.iter_batches(ROWS, [group], places):
                    found = dict(zip(order, batch.columns, strict=True))
                    yield {name: numbers(found[name]) for name in columns}
            except DAMAGE as error:
                rows = self._file.metadata.row_group(group).num_rows
                words = f"row group {group + 1} ({rows} rows): {one_line(error)}"
                self.note_fault(f"group {group}", words)

    def known_ranges(self, table: str) -> KnownRanges | None:
        """From the statistics of the row groups; None if a column of numbers lacks them."""
        found: dict[str, Extremes] = {}
        metadata = self._file.metadata
        groups = [metadata.row_group(g) for g in range(metadata.num_row_groups)]
        for column in self.tables[0].columns:
            if column.kind is not Kind.NUMBER:
                continue
            parts = [group.column(self._places[column.name]).statistics for group in groups]
            kind = self._types[column.name]
            told = _is_plain(kind) and not pa.types.is_float16(kind)  # whose extremes are bytes
            if not (told and parts and all(p is not None and p.has_min_max for p in parts)):
                return None
            low, high = min(p.min for p in parts), max(p.max for p in parts)
            found[column.name] = Extremes(float(low), float(high))
        return KnownRanges("the file's own statistics", found)


class ArrowLog(Log):
    """An Arrow stream, as a run writes while it lasts, or an Arrow IPC file (Feather)."""

    def __init__(self, path: Path, limits: Limits | None = None) -> None:
        try:
            with path.open("rb") as file:
                self._is_file = file.read(6) == b"ARROW1"
            with arrow_file(path) as source:
                columns = _columns(self._reader(source).schema)
        except DAMAGE as error:
            raise InvalidInputError(path.name, one_line(error), "a whole Arrow schema") from None
        super().__init__(path, "Arrow", [Table("", columns)], limits)
        self._places = {column.name: at for at, column in enumerate(columns)}
        _note_texts(self)

    def _reader(self, source: pa.NativeFile) -> ipc.RecordBatchReader:
        return ipc.open_file(source) if self._is_file else ipc.open_stream(source)

    def blocks(self, table: str, columns: Sequence[str]) -> Iterator[Block]:
        """Whole batches; one that was cut ends the reading and is named."""
        rows = 0
        with arrow_file(self.path) as source:
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
                    batch.validate()
                    block = {n: numbers(batch.column(self._places[n])) for n in columns}
                except StopIteration:
                    return
                except DAMAGE as error:
                    self.note_fault("cut", f"cut after row {rows}: {one_line(error)}")
                    return
                number, rows = number + 1, rows + batch.num_rows
                yield block


def numbers(column: pa.Array) -> FloatArray:
    """A column as numbers, NaN where it holds nothing.

    Stamps and dates are seconds since 1970, times of a day seconds since midnight.
    """
    types = pa.types
    if types.is_dictionary(column.type):
        column.validate(full=True)  # a damaged index would read beside the dictionary
        column = column.dictionary_decode()
    kind = column.type
    if types.is_timestamp(kind):
        return seconds_of(pa.chunked_array([column]))
    scale = 1.0
    if types.is_date(kind):
        scale = 86400.0 if types.is_date32(kind) else 1e-3
    elif types.is_duration(kind) or types.is_time(kind):
        scale = 1.0 / TICKS[kind.unit]
    if scale != 1.0 or types.is_temporal(kind):
        column = column.cast(pa.int32() if kind.bit_width == 32 else pa.int64())
    values = column.cast(pa.float64(), safe=False).to_numpy(zero_copy_only=False)
    return np.asarray(values * scale if scale != 1.0 else values)


def _opened(path: Path) -> tuple[pq.ParquetFile, tuple[Column, ...]]:
    try:
        file = pq.ParquetFile(arrow_file(path))
        return file, _columns(file.schema_arrow)
    except DAMAGE as error:
        reason = one_line(error)
        if "magic bytes" in reason or "footer" in reason.lower():
            reason = "cut: the footer at its end, without which no row can be found, is missing"
        raise InvalidInputError(path.name, reason, "a whole Parquet file") from None


def _columns(schema: pa.Schema) -> tuple[Column, ...]:
    found = []
    for field, name in zip(schema, unique_names(schema.names), strict=True):
        said = (field.metadata or {}).get(b"unit", b"").decode("utf-8", "replace")
        unit = spelled(said) or unit_of_name(field.name)
        kind, seconds = _kind(field.type)
        found.append(Column(name, "s" if seconds else unit, kind))
    return tuple(found)


def _kind(kind: pa.DataType) -> tuple[Kind, bool]:
    """What a type holds, and whether reading it makes seconds of it."""
    types = pa.types
    if types.is_dictionary(kind):
        return _kind(kind.value_type)
    if types.is_timestamp(kind) or types.is_date(kind):
        return Kind.STAMP, True
    if types.is_duration(kind) or types.is_time(kind):
        return Kind.NUMBER, True
    return (Kind.NUMBER if _is_plain(kind) or types.is_decimal(kind) else Kind.TEXT), False


def _is_plain(kind: pa.DataType) -> bool:
    """Whether a type is numbers as such: no times, whose units differ, and no decimals."""
    types = pa.types
    return bool(types.is_floating(kind) or types.is_integer(kind) or types.is_boolean(kind))


def _leaves(kind: pa.DataType) -> int:
    """Columns that the file keeps for one of a type: those of its innermost fields."""
    if pa.types.is_dictionary(kind) or not kind.num_fields:
        return 1
    return sum(_leaves(kind.field(i).type) for i in range(kind.num_fields))


def _note_texts(log: Log) -> None:
    texts = [c.name for c in log.tables[0].columns if c.kind is Kind.TEXT]
    if texts:
        log.note_fault("texts", f"no numbers, passed over: {', '.join(texts)}")
