"""CsvLayout: where the rows of a text table begin, and what separates and names its columns."""

from __future__ import annotations

import csv
import re
from dataclasses import dataclass

from ves_twin.core.errors import InvalidInputError
from ves_twin.data.formats.log import Column, Kind, unique_names
from ves_twin.data.formats.unit_names import is_unit, spelled, unit_of_name

MISSING = ("", "nan", "NaN", "NAN", "NA", "N/A", "#N/A", "null", "NULL", "None", "-", "--")
"""Cells that hold nothing."""

SPACES = "spaces"
"""Separator of columns that are lined up with any number of blanks."""

_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?|[+-]?inf(?:inity)?", re.IGNORECASE)
_STAMP = re.compile(
    r"\d{4}-\d\d-\d\d[T ]\d\d:\d\d(?::\d\d(?:[.]\d{1,9})?)?(?P<zone>Z|[+-]\d\d:?\d\d)?"
)
_COMMENT = re.compile(r"^\s*(?:#|%|//)+\s?")
SAMPLE = 50
"""Rows by which kinds are told."""


@dataclass(frozen=True)
class CsvLayout:
    """How to read the rows of a text table.

    Attributes:
        separator: one character, or SPACES.
        decimal: point or comma.
        start: byte at which the first row begins.
        columns: names made unique, units of the header or of the names.
        zoned: columns of stamps that give their zone.
    """

    separator: str
    decimal: str
    start: int
    columns: tuple[Column, ...]
    zoned: frozenset[str] = frozenset()

    @staticmethod
    def of(head: bytes, name: str, whole: bool) -> CsvLayout:
        """The layout told by the first bytes of a file.

        Args:
            head: the begin of the file.
            name: of the file, for messages.
            whole: the head is all of it.

        Raises:
            InvalidInputError: no text, or no rows of numbers.
        """
        if head[:2] in (b"\xff\xfe", b"\xfe\xff"):
            raise InvalidInputError(name, "UTF-16 text", "UTF-8; save it as such")
        if b"\0" in head:
            raise InvalidInputError(name, "an unknown binary file", FORMATS)
        lines = head.splitlines(keepends=True)
        if lines and not whole and not lines[-1].endswith((b"\n", b"\r")):
            lines.pop()
        texts = [_text(line) for line in lines]
        found = max(
            (s for sep in (",", ";", "\t", "|", SPACES) for s in _splits(texts, sep)),
            key=lambda s: s.score,
            default=None,
        )
        if found is None:
            what = "0 rows of numbers" if whole else "no row of numbers at its begin"
            raise InvalidInputError(name, what, FORMATS)
        start = sum(len(line) for line in lines[: found.first])
        columns, zoned = _columns(texts, found)
        return CsvLayout(found.separator, found.decimal, start, columns, zoned)


FORMATS = "rows of numbers in CSV, Parquet, Arrow, MAT v5, npz or MCAP"


@dataclass(frozen=True)
class _Split:
    """A way to split the lines: the first row of numbers, columns, and how well it fits."""

    separator: str
    decimal: str
    first: int
    width: int
    score: tuple[float, int]


def split_line(line: str, separator: str) -> list[str]:
    """Cells of a line, quotes taken off."""
    if separator == SPACES:
        return line.split()
    return [
        cell.strip() for cell in next(csv.reader([line.strip("\r\n")], delimiter=separator), [])
    ]


def _text(line: bytes) -> str:
    line = line.removeprefix(b"\xef\xbb\xbf")
    try:
        return line.decode("utf-8")
    except UnicodeDecodeError:
        return line.decode("latin-1")


def _splits(texts: list[str], separator: str) -> list[_Split]:
    cells = [split_line(text, separator) for text in texts]
    found = []
    for decimal in (".",) if separator == "," else (".", ","):
        good = [_share(row, decimal) for row in cells]
        full = [i for i, share in enumerate(good) if share >= 0.5]
        if not full:
            continue
        width = _usual([len(cells[i]) for i in full])
        first = next(i for i in full if len(cells[i]) == width)
        rows = [i for i in range(len(cells)) if cells[i]]
        fit = sum(good[i] for i in rows[rows.index(first) :] if len(cells[i]) == width) / len(rows)
        commas = decimal == "," and any("," in c for c in cells[first])
        if fit > 0.0 and (decimal == "." or commas):
            found.append(_Split(separator, decimal, first, width, (round(fit, 2), width)))
    return found


def _usual(widths: list[int]) -> int:
    return max(set(widths), key=widths.count)


def _share(row: list[str], decimal: str) -> float:
    """Share of the cells that are numbers, dates or empty; at least one must be a number."""
    numbers = [_is_number(cell, decimal) for cell in row]
    stamps = [bool(_STAMP.fullmatch(cell)) for cell in row]
    if not any(numbers):
        return 0.0
    empty = [cell in MISSING for cell in row]
    return sum(map(any, zip(numbers, stamps, empty, strict=True))) / len(row)


def _is_number(cell: str, decimal: str) -> bool:
    if decimal == ",":
        cell = cell.replace(",", ".") if "." not in cell else "x"
    return bool(_NUMBER.fullmatch(cell))


def _columns(texts: list[str], split: _Split) -> tuple[tuple[Column, ...], frozenset[str]]:
    above = [i for i in range(split.first) if texts[i].strip()]
    heads = [_COMMENT.sub("", texts[i]) for i in above]
    if split.separator == SPACES:  # "x [mm]" is one name
        heads = [re.sub(r"\s+(?=[\[(])", "", head) for head in heads]
    sample = [split_line(t, split.separator) for t in texts[split.first : split.first + SAMPLE]]
    sample = [row for row in sample if len(row) == split.width]
    closed = all(row[-1] == "" for row in sample)
    rows = [_as_wide(split_line(head, split.separator), split.width, closed) for head in heads]
    rows = [row for row in rows if len(row) == split.width]
    units = [""] * split.width
    if len(rows) > 1 and _is_unit_row(rows[-1]):
        units = [spelled(cell.strip("[]()")) for cell in rows.pop()]
    names = rows[-1] if rows else [f"column_{i + 1}" for i in range(split.width)]
    names = unique_names([name or f"column_{i + 1}" for i, name in enumerate(names)])
    columns, zoned = [], set()
    for i, (name, unit) in enumerate(zip(names, units, strict=True)):
        cells = [row[i] for row in sample if row[i] not in MISSING]
        stamps = [_STAMP.fullmatch(cell) for cell in cells]
        kind = Kind.NUMBER if not cells else Kind.TEXT
        if any(_is_number(cell, split.decimal) for cell in cells):
            kind = Kind.NUMBER
        elif cells and all(stamps):
            kind = Kind.STAMP
            if stamps[0] and stamps[0]["zone"]:
                zoned.add(name)
        columns.append(Column(name, unit or unit_of_name(name), kind))
    return tuple(columns), frozenset(zoned)


def _as_wide(row: list[str], width: int, closed: bool) -> list[str]:
    """Cells of a header, where it or the rows alone end with a separator.

    Args:
        row: its cells.
        width: of the rows of numbers.
        closed: whether each of those ends with a separator.
    """
    if len(row) == width - 1 and closed and any(row):
        return [*row, ""]
    return row[:-1] if len(row) == width + 1 and not row[-1] else row


def _is_unit_row(cells: list[str]) -> bool:
    bare = [cell.strip("[]()") for cell in cells]
    return all(not cell or is_unit(cell) for cell in bare) and any(bare)
