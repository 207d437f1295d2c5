"""CsvLog: a text table, parsed in pieces of some megabytes by two threads."""

from __future__ import annotations

import re
from collections import deque
from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.csv as pcsv

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.data.formats.csv_layout import FORMATS, MISSING, SPACES, CsvLayout
from ves_twin.data.formats.limits import Limits
from ves_twin.data.formats.log import Block, Kind, Log, Table

PIECE = 1 << 23
"""Bytes that are parsed at a time: enough to amortise the call, little enough for memory."""

AHEAD = 3
"""Pieces that are under way: one for each of two threads, and the one that is read."""

HEAD = 1 << 16

STAMP = r"^\s*\d{4}-\d\d-\d\d[T ]\d\d:\d\d(:\d\d(\.\d{1,9})?)?(Z|[+-]\d\d:?\d\d)?\s*$"
NUMBER = r"^\s*[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?\s*$"


class CsvLog(Log):
    """Rows of numbers in text: comma, semicolon, tab, bar or blanks; decimal point or comma."""

    def __init__(self, path: Path, limits: Limits | None = None) -> None:
        try:
            with pa.input_stream(str(path)) as stream:
                head = stream.read(HEAD)
                whole = len(head) < HEAD
        except (pa.ArrowInvalid, OSError) as error:
            raise InvalidInputError(path.name, str(error), FORMATS) from None
        self._layout = CsvLayout.of(bytes(head), path.name, whole)
        super().__init__(path, "CSV", [Table("", self._layout.columns)], limits)

    def blocks(self, table: str, columns: Sequence[str]) -> Iterator[Block]:
        """Pieces in the file's order; rows and cells that cannot be read count as faults."""
        count = _Count()
        with ThreadPoolExecutor(2) as pool:
            waiting: deque[Future[tuple[Block, _Count]]] = deque()
            for piece in self._pieces():
                waiting.append(pool.submit(self._parsed, piece, columns))
                if len(waiting) == AHEAD:
                    yield self._counted(waiting.popleft().result(), count)
            while waiting:
                yield self._counted(waiting.popleft().result(), count)

    def _counted(self, found: tuple[Block, _Count], count: _Count) -> Block:
        block, here = found
        count.add(here)
        for key, message in count.messages().items():
            self.note_fault(key, message)
        return block

    def _pieces(self) -> Iterator[bytes]:
        rest, size = bytearray(), 0
        with pa.input_stream(str(self.path)) as stream:
            stream.read(self._layout.start)
            while True:
                try:
                    read = stream.read(PIECE)
                except (pa.ArrowInvalid, OSError) as error:
                    self.note_fault("cut", f"the file breaks off: {error}")
                    read = b""
                if not read:
                    break
                size += len(read)
                self.limits.check_unfolded(self.path, size)
                whole, end, tail = read.rpartition(b"\n")
                first = whole.find(b"\n") if b"\n" in whole else len(whole or tail)
                self.limits.check_line(self.path, len(rest) + first)
                if not end:
                    rest += tail
                    continue
                rest += whole + end
                yield bytes(rest)
                rest = bytearray(tail)
        self.limits.check_line(self.path, len(rest))
        if rest.strip(b" \r\n\t\0"):
            yield bytes(rest)

    def _parsed(self, piece: bytes, wanted: Sequence[str]) -> tuple[Block, _Count]:
        count = _Count()
        if not piece.isascii():  # the parser shows rows of another width as text, which must be one
            piece = piece.decode("utf-8", "replace").encode()
        if self._layout.separator == SPACES:
            piece = re.sub(rb"(?m)^ | $|\r", b"", re.sub(rb"[ \t]+", b" ", piece))
        try:
            table = self._table(piece, wanted, count, texts=False)
        except pa.ArrowInvalid:
            count = _Count()
            table = self._table(piece, wanted, count, texts=True)
        return {name: self._numbers(table.column(name), name, count) for name in wanted}, count

    def _table(self, piece: bytes, wanted: Sequence[str], count: _Count, texts: bool) -> pa.Table:
        layout = self._layout

        def skip(row: pcsv.InvalidRow) -> str:
            count.rows += 1
            return "skip"

        kinds = {c.name: c.kind for c in layout.columns}
        types = {n: pa.string() if texts else self._type(n, kinds[n]) for n in wanted}
        separator = " " if layout.separator == SPACES else layout.separator
        return pcsv.read_csv(
            pa.BufferReader(piece),
            pcsv.ReadOptions(
                use_threads=False,
                block_size=len(piece) + 1,
                column_names=[c.name for c in layout.columns],
            ),
            pcsv.ParseOptions(delimiter=separator, invalid_row_handler=skip),
            pcsv.ConvertOptions(
                check_utf8=False,
                column_types=types,
                include_columns=list(wanted),
                null_values=list(MISSING),
                strings_can_be_null=True,
                decimal_point=layout.decimal,
                timestamp_parsers=[pcsv.ISO8601],
            ),
        )

    def _type(self, name: str, kind: Kind) -> pa.DataType:
        if kind is Kind.STAMP:
            return pa.timestamp("ns", tz="UTC" if name in self._layout.zoned else None)
        return pa.float64()

    def _numbers(self, column: pa.ChunkedArray, name: str, count: _Count) -> FloatArray:
        if pa.types.is_timestamp(column.type):
            return seconds_of(column)
        if not pa.types.is_string(column.type):
            return np.asarray(column.to_numpy(), dtype=np.float64)
        kind = next(c.kind for c in self._layout.columns if c.name == name)
        if self._layout.decimal == "," and kind is Kind.NUMBER:
            column = pc.replace_substring(column, ",", ".")
        good = pc.match_substring_regex(column, STAMP if kind is Kind.STAMP else NUMBER)
        count.cells[name] = pc.sum(pc.invert(good)).as_py() or 0
        column = pc.if_else(good, pc.utf8_trim_whitespace(column), None)
        if kind is Kind.NUMBER:
            return np.asarray(column.cast(pa.float64()).to_numpy(), dtype=np.float64)
        try:
            return seconds_of(column.cast(self._type(name, kind)))
        except pa.ArrowInvalid:  # a month 13
            count.cells[name] = len(column)
            return np.full(len(column), np.nan)


TICKS = {"s": 1, "ms": 10**3, "us": 10**6, "ns": 10**9}
"""Unit of Arrow's times -> ticks a second."""


def seconds_of(column: pa.ChunkedArray) -> FloatArray:
    """Stamps as seconds since 1970, good to a quarter of a microsecond; NaN where missing."""
    whole = column.cast(pa.int64())
    missing = whole.is_null().to_numpy()
    ticks, each = whole.fill_null(0).to_numpy(), TICKS[column.type.unit]
    return np.asarray(np.where(missing, np.nan, ticks // each + (ticks % each) / each))


class _Count:
    """Rows and cells that could not be read."""

    def __init__(self) -> None:
        self.rows = 0
        self.cells: dict[str, int] = {}

    def add(self, other: _Count) -> None:
        """Count on."""
        self.rows += other.rows
        for name, number in other.cells.items():
            self.cells[name] = self.cells.get(name, 0) + number

    def messages(self) -> dict[str, str]:
        """What to say."""
        said = {
            f"cells of {name}": f"{name}: {number} cells are no numbers and count as missing"
            for name, number in self.cells.items()
            if number
        }
        if self.rows:
            said["rows"] = f"{self.rows} rows have another number of columns and were left out"
        return said
