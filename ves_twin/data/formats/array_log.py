"""ArrayLog: named arrays, gathered into tables of arrays that have one length."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.data.formats.limits import Limits
from ves_twin.data.formats.log import Block, Column, Log, Table
from ves_twin.data.formats.unit_names import spelled, unit_of_name

Groups = Mapping[str, Mapping[str, np.ndarray]]
"""Container (empty: top level) -> name -> array."""

CELLS = 1 << 22
"""Numbers of a block: 32 MiB as doubles."""


class ArrayLog(Log):
    """Arrays of a MAT or npz file.

    Vectors are columns; a matrix gives a column for each of its short side, numbered from 1.
    Arrays of one container that differ in length come as tables of their own, named by length.
    """

    def __init__(
        self,
        path: Path,
        form: str,
        groups: Groups,
        units: Mapping[str, str] | None = None,
        faults: Sequence[str] = (),
        limits: Limits | None = None,
    ) -> None:
        self._data: dict[str, dict[str, FloatArray]] = {}
        constants = []
        for container, arrays in groups.items():
            tables, single = _tables(container, arrays)
            self._data |= tables
            constants += single
        known = units or {}
        tables_ = [
            Table(
                name,
                tuple(Column(c, _unit(c, known)) for c in columns),
                len(next(iter(columns.values()))),
            )
            for name, columns in self._data.items()
        ]
        super().__init__(path, form, tables_, limits)
        for fault in faults:
            self.note_fault(fault, fault)
        if constants:
            words = f"single numbers, no channels: {', '.join(constants)}"
            self.note_fault("constants", words)

    def blocks(self, table: str, columns: Sequence[str]) -> Iterator[Block]:
        """Rows as doubles, some at a time: a file of bytes is an eighth of that in memory."""
        rows, step = self.table(table).rows or 0, max(CELLS // max(len(columns), 1), 2)
        for start in range(0, rows, step):
            part = slice(start, start + step)
            with np.errstate(
                invalid="ignore"
            ):  # a signalling NaN of single precision is a hole, too
                found = {n: np.asarray(self._data[table][n][part], np.float64) for n in columns}
            yield found


def _unit(column: str, known: Mapping[str, str]) -> str:
    """As the file's `units` say, where a struct field cannot hold a point; else by the name."""
    return spelled(known.get(column.replace(".", "_"), "")) or unit_of_name(column)


def _tables(
    container: str, arrays: Mapping[str, np.ndarray]
) -> tuple[dict[str, dict[str, FloatArray]], list[str]]:
    vectors = {array.size for array in arrays.values() if _is_vector(array) and array.size > 1}
    by_length: dict[int, dict[str, FloatArray]] = {}
    constants = []
    for name, array in arrays.items():
        if array.size == 1:
            constants.append(f"{container}.{name}" if container else name)
            continue
        rows = _upright(array, vectors)
        columns = by_length.setdefault(len(rows), {})
        if rows.shape[1] == 1:
            columns[name] = rows[:, 0]
        else:
            columns |= {f"{name}.{i + 1}": rows[:, i] for i in range(rows.shape[1])}
    lengths = sorted(by_length, key=lambda n: -len(by_length[n]) * n)
    tables = {}
    for place, length in enumerate(lengths):
        extra = f"{container or 'rows'}_{length}"
        tables[container if place == 0 else extra] = by_length[length]
    return tables, constants


def _is_vector(array: np.ndarray) -> bool:
    return array.size == max(array.shape, default=0)


def _upright(array: np.ndarray, vectors: set[int]) -> np.ndarray:
    """Time along rows (n, k): the side as long as a vector beside it, else the longer one."""
    if _is_vector(array):
        return array.reshape(-1, 1)
    rows = array.reshape(array.shape[0], -1)
    sideways = array.ndim == 2 and rows.shape[1] > rows.shape[0]
    if array.ndim == 2 and rows.shape[0] in vectors:
        sideways = False
    elif array.ndim == 2 and rows.shape[1] in vectors:
        sideways = True
    return rows.T if sideways else rows
