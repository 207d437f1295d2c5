"""stream_batches: the batches of an Arrow IPC stream of ours that are whole and as written.

Each batch carries a checksum of its rows and of the schema; streams of earlier versions have none.
"""

from __future__ import annotations

import mmap
import warnings
import zlib
from collections.abc import Iterator
from typing import BinaryIO

import pyarrow as pa
import pyarrow.ipc as ipc

from ves_twin.core.errors import FileAccessError, VesTwinWarning

CHECKSUM = b"crc32"
"""Key of a batch's metadata."""

_MARK = b"\xff\xff\xff\xff"
_PREFIX = 8
"""Bytes before each message: the mark and the length of its head. Messages begin at multiples."""

_END = _MARK + bytes(4)

_UNREADABLE = (pa.ArrowException, OSError, ValueError, EOFError, StopIteration)


def batch_checksum(batch: pa.RecordBatch) -> bytes:
    """CRC-32 of names, metadata and rows of a batch of float64 columns, as hexadecimal digits.

    Raises:
        pa.ArrowInvalid: a column that is not whole float64.
    """
    schema = batch.schema
    words = [(field.name, sorted((field.metadata or {}).items())) for field in schema]
    found = zlib.crc32(repr((words, sorted((schema.metadata or {}).items()))).encode())
    for column in batch.columns:
        values = column.to_numpy(zero_copy_only=True)
        found = zlib.crc32(values.tobytes(), found)
    return b"%08x" % found


def stream_batches(file: BinaryIO, name: object) -> Iterator[pa.RecordBatch]:
    """The batches of a stream file; one that a kill has cut ends them.

    Rows that were changed since they were written are left out; a VesTwinWarning says which.

    Args:
        file: open for reading, with a file handle.
        name: of the file, for messages.

    Raises:
        FileAccessError: cut before its first batch, or damaged there.
    """
    try:
        content = pa.py_buffer(mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ))
        source = pa.BufferReader(content)
        ipc.read_message(source)
        walk = _Walk(content, source.tell())
    except _UNREADABLE:  # an empty file, or no head
        raise FileAccessError(f"recording {name} was cut before its first row") from None
    last, missing = None, False
    for batch in walk:
        if batch is None:
            missing = True
            continue
        if missing:
            _tell(name, last, batch)
        last, missing = batch, False
        yield batch
    if missing:
        _tell(name, last, None)


class _Walk:
    """Batches in the order of the file; None for each place where there is none as written."""

    def __init__(self, content: pa.Buffer, begin: int) -> None:
        self._content = content
        self._bytes = memoryview(content).cast("B")
        self._head = bytes(self._bytes[:begin])
        self._at = begin
        self._checked = False

    def __iter__(self) -> Iterator[pa.RecordBatch | None]:
        while self._at < len(self._bytes) and self._bytes[self._at :][:_PREFIX] != _END:
            end = self._end(self._at)
            if end is None and self._cut():
                return
            batch = None if end is None else self._batch(self._at, end)
            yield batch
            self._at = end if batch is not None and end is not None else self._next()

    def _end(self, at: int) -> int | None:
        """Where the message that begins here ends, if there is a whole one."""
        source = pa.BufferReader(self._content)
        source.seek(at)
        try:
            ipc.read_message(source)
        except _UNREADABLE:
            return None
        return int(source.tell())

    def _batch(self, at: int, end: int) -> pa.RecordBatch | None:
        """The batch of a message, unless it was changed."""
        try:
            stream = pa.py_buffer(self._head + self._bytes[at:end])
            batch, told = ipc.open_stream(stream).read_next_batch_with_custom_metadata()
            checksum = (told or {}).get(CHECKSUM)
            if checksum is None:
                return None if self._checked else batch
            self._checked = True
            return batch if checksum == batch_checksum(batch) else None
        except _UNREADABLE:
            return None

    def _next(self) -> int:
        """The next place that may begin a message."""
        for at in range(self._at + _PREFIX, len(self._bytes), _PREFIX):
            if self._bytes[at : at + 4] == _MARK and self._end(at) is not None:
                return at
        return len(self._bytes)

    def _cut(self) -> bool:
        """Whether a message begins here whose rest was never written."""
        rest = self._bytes[self._at :]
        if len(rest) < _PREFIX:
            return True
        return rest[:4] == _MARK and bytes(self._bytes[-_PREFIX:]) != _END


def _tell(name: object, before: pa.RecordBatch | None, after: pa.RecordBatch | None) -> None:
    """Say which rows are left out."""
    span = [f"after {before['t'][-1].as_py():.6g} s"] if before is not None else []
    span += [f"before {after['t'][0].as_py():.6g} s"] if after is not None else []
    where = " and ".join(span) or "from the first row on"
    warnings.warn(
        f"recording {name} was changed since it was written: rows {where} are left out",
        VesTwinWarning,
        stacklevel=3,
    )
