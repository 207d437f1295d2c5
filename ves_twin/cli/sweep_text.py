"""sweep_text: the first rows of a sweep's table as a person reads them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import pyarrow.parquet as pq

from ves_twin.core.arrow_file import arrow_file
from ves_twin.core.signals import SIGNALS
from ves_twin.report.sweep_picture import KINDS

MOST_ROWS = 12
"""Rows that are printed; the table has them all."""

WIDEST = 24
"""Characters of a varied value or an outcome; longer ones are cut."""

_MILLI = 1e3


def sweep_rows(table: Path, keys: Mapping[str, str]) -> list[str]:
    """Lines with point, varied keys, outcome and rms errors of the first points.

    Args:
        table: the Parquet table of a sweep.
        keys: varied key -> unit.
    """
    with arrow_file(table) as file:
        found = pq.read_table(file)
    rows = found.slice(0, MOST_ROWS).to_pylist()
    prefix = next((name for name in KINDS if f"{name}.x.rms" in found.column_names), "")
    axes = SIGNALS["truth.pose"].axes if prefix else ()
    head = ["point", *keys, "outcome", *axes]
    cells = [
        [
            *(_short(row[name]) for name in ("point", *keys, "outcome")),
            *(_milli(row[f"{prefix}.{axis}.rms"]) for axis in axes),
        ]
        for row in rows
    ]
    widths = [max(map(len, column)) for column in zip(head, *cells, strict=True)]
    lines = [_line(line, widths) for line in (head, *cells)]
    if len(found) > MOST_ROWS:
        lines.append(f"  ... and {len(found) - MOST_ROWS} rows more in the table")
    if prefix:
        lines.append(f"  (x to rz: rms of the {KINDS[prefix]} in mm and mrad, up to the run's end)")
    return lines


def _line(cells: Sequence[str], widths: Sequence[int]) -> str:
    return "  " + "  ".join(f"{cell:>{width}}" for cell, width in zip(cells, widths, strict=True))


def _short(value: object) -> str:
    text = f"{value:.6g}" if isinstance(value, float) else str(value)
    return text if len(text) <= WIDEST else text[: WIDEST - 3] + "..."


def _milli(value: float | None) -> str:
    return "-" if value is None else f"{_MILLI * value:.3f}"
