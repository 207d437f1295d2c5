"""read_columns: named columns of numbers from a CSV or Parquet file."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.csv
import pyarrow.parquet

from ves_twin.core.arrow_file import arrow_file
from ves_twin.core.errors import FileAccessError, InvalidInputError, one_line
from ves_twin.core.types import FloatArray

READERS = {".csv": pa.csv.read_csv, ".parquet": pa.parquet.read_table}
"""Ending of a file -> what reads it."""

QUOTED_ROW = re.compile(r"(columns, got \d+): .*")
"""The row that pyarrow quotes: a file that somebody named by mistake is not for the terminal."""


def read_columns(
    kind: str, path: Path, names: Sequence[str], *optional: Sequence[str]
) -> tuple[FloatArray, list[FloatArray | None]]:
    """Columns of a file, by groups that belong together.

    Args:
        kind: word for messages, for instance "operator file".
        path: .csv with a header, or .parquet.
        names: columns that have to be there.
        *optional: groups of columns that may be there; of none a part.

    Returns:
        Finite numbers (n, columns) under `names`, and of each other group; None where it is absent.

    Raises:
        FileAccessError: unreadable.
        InvalidInputError: another ending, columns missing, or values that are no finite numbers.
    """
    if path.suffix not in READERS:
        raise InvalidInputError(kind, str(path), f"a file that ends in {' or '.join(READERS)}")
    try:
        with arrow_file(path) as file:
            table = READERS[path.suffix](file)
        rest = [_group(table, group, path) if _any(table, group) else None for group in optional]
        return _group(table, names, path), rest
    except OSError as error:
        raise FileAccessError(f"{kind} {path}: {one_line(error)}") from None
    except (pa.ArrowException, ValueError, TypeError) as error:
        expected = f"numbers under {', '.join(names)}"
        told = QUOTED_ROW.sub(r"\1", one_line(error))
        raise InvalidInputError(path.name, told, expected) from None


def _any(table: pa.Table, names: Sequence[str]) -> bool:
    return any(name in table.column_names for name in names)


def _group(table: pa.Table, names: Sequence[str], path: Path) -> FloatArray:
    if any(name not in table.column_names for name in names):
        raise InvalidInputError(path.name, f"columns {table.column_names}", ", ".join(names))
    rows = np.column_stack([table.column(name).to_numpy().astype(float) for name in names])
    if not np.all(np.isfinite(rows)):
        raise InvalidInputError(path.name, "values that are not finite", "numbers")
    return rows
