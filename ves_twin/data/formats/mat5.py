"""mat_variables: the variables of a MAT file of version 5 to 7, every length checked.

scipy's reader ends the process at some damaged files (a cell array with a wrong byte count), so
the elements are taken apart here; tests hold the result against scipy's at sound files.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ves_twin.core.errors import VesTwinError, one_line
from ves_twin.data.formats.limits import Limits

HEADER = 128
MATRIX, COMPRESSED = 14, 15
DEEPEST = 32
"""Structs in structs."""

NUMBERS = {
    1: "i1",
    2: "u1",
    3: "i2",
    4: "u2",
    5: "i4",
    6: "u4",
    7: "f4",
    9: "f8",
    12: "i8",
    13: "u8",
}
"""Type of an element -> NumPy code (MAT-File Format, table 1-1)."""

TEXTS = {1: "latin-1", 2: "latin-1", 4: "utf-16", 16: "utf-8", 17: "utf-16", 18: "utf-32"}
CELL, STRUCT, OBJECT, CHAR, SPARSE, FUNCTION, OPAQUE = 1, 2, 3, 4, 5, 16, 17
"""Classes of an array (table 1-3); 6 to 15 are numbers."""

COMPLEX = 0x0800


class MatKind(StrEnum):
    """What a variable is."""

    NUMBERS = "numbers"
    COMPLEX = "complex"
    TEXT = "text"
    CELL = "cell"
    STRUCT = "struct"
    SPARSE = "sparse"
    FUNCTION = "function"
    OBJECT = "object"


@dataclass(frozen=True)
class MatValue:
    """A variable, a field or a cell.

    Attributes:
        name: empty inside cells and structs.
        kind: what it is.
        numbers: of NUMBERS, in the shape that MATLAB has.
        text: of TEXT; the class of an OBJECT.
        cells: of a CELL, column by column.
        fields: of a STRUCT, a table for each element.
    """

    name: str
    kind: MatKind
    numbers: NDArray[np.generic] | None = None
    text: str = ""
    cells: tuple[MatValue, ...] = ()
    fields: tuple[dict[str, MatValue], ...] = ()


class DamagedError(VesTwinError):
    """Bytes that are no sound variable."""


def mat_variables(path: Path, limits: Limits | None = None) -> Iterator[MatValue | DamagedError]:
    """Variables one by one; a damaged one comes as what is wrong with it.

    Raises:
        InvalidInputError: together they unfold to more than they may.
    """
    unfolded = 0
    with path.open("rb") as file:
        head = file.read(HEADER)
        order = ">" if head[126:128] == b"MI" else "<"
        while tag := file.read(8):
            try:
                if len(tag) < 8:
                    raise DamagedError("cut")
                kind, size = struct.unpack(f"{order}II", tag)
                content = file.read(size)
                if len(content) < size:
                    raise DamagedError(f"cut: {len(content)} of {size} bytes")
                if kind == COMPRESSED:
                    kind, content = _unpacked(content, order, path, limits or Limits(), unfolded)
                    unfolded += len(content)
                if kind != MATRIX:
                    raise DamagedError(f"element of type {kind}, expected a matrix")
                yield _Reader(content, order).matrix()
            except DamagedError as error:
                yield error
            except (struct.error, zlib.error, ValueError, OverflowError, UnicodeError) as error:
                yield DamagedError(one_line(error))


def _unpacked(
    content: bytes, order: str, path: Path, limits: Limits, before: int
) -> tuple[int, bytes]:
    """Type and bytes of a compressed element, unfolded no further than the limits."""
    stream = zlib.decompressobj()
    kind, size = struct.unpack(f"{order}II", stream.decompress(content, 8))
    most = min(size, limits.most(path) - before + 1)
    whole = stream.decompress(stream.unconsumed_tail, max(most, 1))
    limits.check_unfolded(path, before + len(whole))
    stream.decompress(stream.unconsumed_tail, 8)  # padding, and the sum that proves the rest
    if not stream.eof:
        raise DamagedError("compressed data beyond its size")
    return kind, whole


class _Reader:
    """Takes the elements of one variable apart."""

    def __init__(self, content: bytes, order: str, depth: int = 0) -> None:
        self._content = content
        self._order = order
        self._depth = depth
        self._at = 0
        if depth > DEEPEST:
            raise DamagedError("nested beyond reason")

    def matrix(self) -> MatValue:
        """The variable."""
        if not self._content:  # an empty cell
            return MatValue("", MatKind.NUMBERS, np.zeros((0, 0)))
        _, flags_data = self._element()
        flags, _ = struct.unpack(f"{self._order}II", flags_data)
        kind = flags & 0xFF
        if kind == OPAQUE:
            name, _, label = (self._text() for _ in range(3))
            return MatValue(name, MatKind.OBJECT, text=label)
        dims = self._integers()
        name = self._text()
        if any(d < 0 for d in dims) or len(dims) < 2:
            raise DamagedError(f"{name}: dimensions {dims}")
        count = int(np.prod([int(d) for d in dims], dtype=object))
        if kind in (CELL, STRUCT) and count > len(self._content):
            raise DamagedError(f"{name}: {count} elements in {len(self._content)} bytes")
        if 6 <= kind <= 15:
            numbers = self._numbers(count, name).reshape(dims, order="F")
            is_complex = bool(flags & COMPLEX)
            return MatValue(name, MatKind.COMPLEX if is_complex else MatKind.NUMBERS, numbers)
        return self._other(kind, name, count)

    def _other(self, kind: int, name: str, count: int) -> MatValue:
        """What is no array of numbers."""
        if kind == CELL:
            return MatValue(name, MatKind.CELL, cells=tuple(self._inner() for _ in range(count)))
        if kind == STRUCT:
            return MatValue(name, MatKind.STRUCT, fields=self._fields(count))
        if kind == OBJECT:
            return MatValue(name, MatKind.OBJECT, text=self._text())
        if kind == CHAR:
            return MatValue(name, MatKind.TEXT, text=self._text() if count else "")
        if kind in (FUNCTION, SPARSE):
            return MatValue(name, MatKind.FUNCTION if kind == FUNCTION else MatKind.SPARSE)
        raise DamagedError(f"{name}: array of class {kind}")

    def _element(self) -> tuple[int, bytes]:
        """Type and bytes of the next element; up to four bytes are packed into its tag."""
        (first,) = struct.unpack_from(f"{self._order}I", self._content, self._at)
        if first >> 16:
            kind, size, start = first & 0xFFFF, first >> 16, self._at + 4
            self._at += 8
            if size > 4:
                raise DamagedError(f"{size} bytes in a tag")
        else:
            (size,) = struct.unpack_from(f"{self._order}I", self._content, self._at + 4)
            kind, start = first, self._at + 8
            self._at = start + size + (-size % 8)
        content = self._content[start : start + size]
        if len(content) < size:
            raise DamagedError(f"cut: {len(content)} of {size} bytes")
        return kind, content

    def _integers(self) -> list[int]:
        _, content = self._element()
        return list(struct.unpack(f"{self._order}{len(content) // 4}i", content))

    def _text(self) -> str:
        kind, content = self._element()
        name = TEXTS.get(kind, "latin-1")
        if name == "utf-16" or name == "utf-32":
            name += "-le" if self._order == "<" else "-be"
        return content.decode(name, "replace").rstrip("\0")

    def _numbers(self, count: int, name: str) -> NDArray[np.generic]:
        kind, content = self._element()
        if kind not in NUMBERS:
            raise DamagedError(f"{name}: numbers of type {kind}")
        values = np.frombuffer(content, np.dtype(f"{self._order}{NUMBERS[kind]}"))
        if len(values) != count:
            raise DamagedError(f"{name}: {len(values)} of {count} numbers")
        return values

    def _inner(self) -> MatValue:
        kind, content = self._element()
        if kind != MATRIX:
            raise DamagedError(f"element of type {kind}, expected a matrix")
        return _Reader(content, self._order, self._depth + 1).matrix()

    def _fields(self, count: int) -> tuple[dict[str, MatValue], ...]:
        (length,) = self._integers()[:1] or [0]
        _, raw = self._element()
        if length <= 0 and raw:
            raise DamagedError("field names of no length")
        texts = [raw[i : i + length] for i in range(0, len(raw), length)] if raw else []
        names = [text.split(b"\0", 1)[0].decode("latin-1") for text in texts]
        return tuple({name: self._inner() for name in names} for _ in range(count))
