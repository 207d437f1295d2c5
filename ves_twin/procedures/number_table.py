"""write_table: named columns of numbers as a CSV file."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.core.whole_file import whole_file


def write_table(path: Path, columns: Mapping[str, FloatArray]) -> None:
    """Write columns of equal length; the heading is `name [unit]` as given.

    Raises:
        FileAccessError: the file cannot be written.
    """
    rows = np.column_stack(list(columns.values()))
    with whole_file(path) as partial, partial.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        writer.writerows([f"{value:.9g}" for value in row] for row in rows)
