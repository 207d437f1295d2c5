"""mat_log: a MAT file of version 4 to 7 as arrays; what has no numbers is named with its remedy."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import scipy.io

from ves_twin.core.errors import InvalidInputError, one_line
from ves_twin.data.formats.array_log import ArrayLog
from ves_twin.data.formats.limits import Limits
from ves_twin.data.formats.mat5 import DamagedError, MatKind, MatValue, mat_variables

SAVE_V7 = "load('{name}'); save('{stem}_v7.mat', '-v7')"
"""MATLAB line that makes a version 7.3 file readable."""

CONVERT = {
    "timetable": (
        "S = table2struct(timetable2table({x}), 'ToScalar', true);"
        " S.Time = seconds({x}.Properties.RowTimes); save('{x}.mat', '-struct', 'S', '-v7')"
    ),
    "table": ("S = table2struct({x}, 'ToScalar', true); save('{x}.mat', '-struct', 'S', '-v7')"),
    "timeseries": (
        "S = struct('t', {x}.Time, 'x', squeeze({x}.Data)); save('{x}.mat', '-struct', 'S', '-v7')"
    ),
    "datetime": "{x}_s = posixtime({x}); save('{x}.mat', '{x}_s', '-v7')",
    "duration": "{x}_s = seconds({x}); save('{x}.mat', '{x}_s', '-v7')",
    "string": "{x}_c = cellstr({x}); save('{x}.mat', '{x}_c', '-v7')",
}
"""Class of an object -> MATLAB line that turns it into arrays."""
ANY = "S = struct({x}); save('{x}.mat', '-struct', 'S', '-v7')"


def mat_log(path: Path, limits: Limits | None = None) -> ArrayLog:
    """A MAT file as a log; a damaged variable costs only itself.

    Raises:
        InvalidInputError: version 7.3 (HDF5), beyond limits, or nothing in it can be read.
    """
    limits = limits or Limits()
    found = _Found()
    for number, value in enumerate(_variables(path, limits), 1):
        if isinstance(value, DamagedError):
            found.faults.append(f"variable {number}: cut or damaged, left out: {value}")
        elif value.name and not value.name.startswith("__"):
            found.take("", value.name, value)
    if not found.groups:
        words = "; ".join(found.faults) or "0 variables"
        raise InvalidInputError(path.name, words, "arrays of numbers")
    return ArrayLog(path, "MAT", found.groups, found.units, found.faults, limits)


def _variables(path: Path, limits: Limits) -> Iterator[MatValue | DamagedError]:
    with path.open("rb") as file:
        if file.read(8) == b"MATLAB 5":
            yield from mat_variables(path, limits)
            return
    try:
        content = scipy.io.loadmat(str(path))
    except NotImplementedError:
        raise mat_73(path) from None
    except Exception as error:  # version 4 has no mark, so anything may come here
        raise InvalidInputError(path.name, f"damaged: {one_line(error)}", "a MAT file") from None
    for name, value in content.items():
        if isinstance(value, np.ndarray) and value.dtype.kind in "fiub":
            yield MatValue(name, MatKind.NUMBERS, value)
        elif isinstance(value, np.ndarray) and value.dtype.kind == "c":
            yield MatValue(name, MatKind.COMPLEX)
        elif not name.startswith("__"):
            yield MatValue(name, MatKind.SPARSE)


def mat_73(path: Path) -> InvalidInputError:
    """What to say of a file of version 7.3."""
    line = SAVE_V7.format(name=path.name, stem=path.stem)
    return InvalidInputError(path.name, "a MAT file of version 7.3 (HDF5)", f"v7; MATLAB: {line}")


class _Found:
    """Arrays by container, units, and what had to be left out."""

    def __init__(self) -> None:
        self.groups: dict[str, dict[str, np.ndarray]] = {}
        self.units: dict[str, str] = {}
        self.faults: list[str] = []

    def take(self, container: str, name: str, value: MatValue) -> None:
        """Take a variable, or a field of the struct that is called `container`."""
        full = f"{container}.{name}" if container else name
        if value.kind is MatKind.NUMBERS and value.numbers is not None:
            if value.numbers.size:
                self.groups.setdefault(container, {})[name] = value.numbers
            else:
                self.faults.append(f"{full}: empty")
        elif value.kind is MatKind.STRUCT:
            self._take_struct(full, value)
        elif value.kind is MatKind.CELL:
            self._take_cells(full, value)
        elif value.kind is MatKind.OBJECT:
            self.faults.append(_remedy(full, value.text or "object"))
        elif value.kind in LEFT_OUT:
            self.faults.append(f"{full}: {LEFT_OUT[value.kind].format(x=full, n=name)}")

    def _take_struct(self, full: str, value: MatValue) -> None:
        for place, element in enumerate(value.fields):
            here = full if len(value.fields) == 1 else f"{full}({place + 1})"
            for field, content in element.items():
                if full == "units":
                    self.units[field] = content.text
                else:
                    self.take(here, field, content)

    def _take_cells(self, full: str, value: MatValue) -> None:
        kinds = {cell.kind for cell in value.cells}
        if kinds == {MatKind.NUMBERS}:
            for place, cell in enumerate(value.cells):
                self.take(full, f"{place + 1}", cell)
        elif kinds - {MatKind.TEXT}:
            self.faults.append(f"{full}: a cell array of mixed content, left out")


LEFT_OUT = {
    MatKind.COMPLEX: "complex, left out; MATLAB: {n}_re = real({x}); {n}_im = imag({x})",
    MatKind.FUNCTION: "a function, left out; no code is run",
    MatKind.SPARSE: "sparse, left out; MATLAB: {n} = full({x})",
}
"""What holds no channels -> what is said of it."""


def _remedy(full: str, kind: str) -> str:
    line = CONVERT.get(kind, ANY).format(x=full)
    return f"{full}: a MATLAB {kind}, which only MATLAB can open; there: {line}"
