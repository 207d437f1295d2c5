"""Log: a lab file as tables of columns; its one verb reads columns in pieces."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from itertools import pairwise
from pathlib import Path

import numpy as np

from ves_twin.core.errors import UnknownNameError
from ves_twin.core.types import FloatArray
from ves_twin.data.formats.limits import Limits

Block = Mapping[str, FloatArray]
"""A piece of some columns of one table: name -> rows (n,), NaN where the file holds nothing."""


class Kind(StrEnum):
    """What a column holds; stamps are dates, read as seconds since 1970; text is only named."""

    NUMBER = "number"
    STAMP = "stamp"
    TEXT = "text"


@dataclass(frozen=True)
class Column:
    """One column.

    Attributes:
        name: as a map names it.
        unit: that the file gives it; empty: none.
        kind: of what it holds.
        said: what the file calls it otherwise: a joint beside a place in an array; empty: nothing.
    """

    name: str
    unit: str = ""
    kind: Kind = Kind.NUMBER
    said: str = ""


@dataclass(frozen=True)
class Table:
    """Columns that share rows: a CSV file, a topic, arrays of one length.

    Attributes:
        name: empty where the file is one table.
        columns: in the file's order.
        rows: None where only reading tells.
    """

    name: str
    columns: tuple[Column, ...]
    rows: int | None = None

    def full_name(self, column: str) -> str:
        """Name of a column in a map: with the table's name before it, if it has one."""
        return f"{self.name}.{column}" if self.name else column


@dataclass(frozen=True)
class Extremes:
    """Smallest and largest value of a column."""

    low: float
    high: float


@dataclass(frozen=True)
class KnownRanges:
    """What a file tells of its columns without being read: by column, and whence."""

    basis: str
    extremes: Mapping[str, Extremes]


class Log(ABC):
    """A lab file that is open for reading.

    Attributes:
        path: the file.
        form: kind of file, for people.
        tables: what is in it.
        limits: beyond which it is refused.
    """

    def __init__(
        self, path: Path, form: str, tables: Sequence[Table], limits: Limits | None = None
    ) -> None:
        self.path = path
        self.limits = limits or Limits()
        self.form = form
        self.tables = tuple(tables)
        self._faults: dict[str, str] = {}

    @abstractmethod
    def blocks(self, table: str, columns: Sequence[str]) -> Iterator[Block]:
        """Columns of a table piece by piece, rows in the file's order.

        What cannot be read is named in `faults`; the rest comes.
        """

    def known_ranges(self, table: str) -> KnownRanges | None:
        """Ranges of a table's columns that need no reading; None: read it."""
        return None

    @property
    def faults(self) -> tuple[str, ...]:
        """What could not be read so far, a line each."""
        return tuple(self._faults.values())

    def note_fault(self, key: str, message: str) -> None:
        """Name something that cannot be read; a later message under the same key replaces it."""
        self._faults[key] = message

    def table(self, name: str) -> Table:
        """A table by name; raises UnknownNameError."""
        for table in self.tables:
            if table.name == name:
                return table
        raise UnknownNameError(f"table in {self.path.name}", name, [t.name for t in self.tables])

    def full_names(self) -> dict[str, tuple[Table, Column]]:
        """Every column by its full name."""
        return {t.full_name(c.name): (t, c) for t in self.tables for c in t.columns}

    def read(self, table: str, columns: Sequence[str]) -> dict[str, FloatArray]:
        """Whole columns (n,) of a table; raises InvalidInputError where they are beyond limits."""
        pieces: dict[str, list[FloatArray]] = {name: [] for name in columns}
        size = 0
        for block in self.blocks(table, columns):
            size += sum(rows.nbytes for rows in block.values())
            self.limits.check_unfolded(self.path, size)
            for name in columns:
                pieces[name].append(block[name])
        return {
            name: np.concatenate(pieces.pop(name)) if pieces[name] else np.zeros(0)
            for name in columns
        }


def unique_names(names: list[str]) -> list[str]:
    """Names with a number behind those that repeat: x, x.2; as many as came."""
    seen: dict[str, int] = {}
    result = []
    for name in names:
        seen[name] = seen.get(name, 0) + 1
        result.append(name if seen[name] == 1 else f"{name}.{seen[name]}")
    doubled = [a for a, b in pairwise(sorted(result)) if a == b]
    return unique_names([f"{n}_" if n in doubled else n for n in result]) if doubled else result
