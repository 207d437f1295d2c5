"""mat_log: a MAT file of version 4 to 7 as arrays; what has no numbers is named with its remedy."""

from __future__ import annotations

import io
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import IO, Any

import numpy as np
import scipy.io
from scipy.io.matlab import MatlabFunction, MatlabObject, MatlabOpaque

from ves_twin.errors import InvalidInputError, one_line
from ves_twin.measured.array_log import ArrayLog

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

HEADER = 128
"""Bytes before the first variable of a version 5 file; the last two tell the byte order."""


def mat_log(path: Path) -> ArrayLog:
    """A MAT file as a log; variables are read one by one, so that a bad one costs only itself.

    Raises:
        InvalidInputError: version 7.3 (HDF5), or nothing in it can be read.
    """
    found = _Found()
    for number, piece in enumerate(_variables(path), 1):
        try:
            content = scipy.io.loadmat(piece)
        except NotImplementedError:
            raise mat_73(path) from None
        except Exception as error:  # zlib, struct and the library's own
            words = f"variable {number}: cut or damaged, left out: {one_line(error)}"
            found.faults.append(words)
            continue
        for name, value in content.items():
            if not name.startswith("__"):
                found.take(name, value)
    if not found.groups:
        words = "; ".join(found.faults) or "0 variables"
        raise InvalidInputError(path.name, words, "arrays of numbers")
    return ArrayLog(path, "MAT", found.groups, found.units, found.faults)


def _variables(path: Path) -> Iterator[IO[bytes]]:
    """Each variable of a version 5 file as a file of its own; one of version 4 whole."""
    with path.open("rb") as file:
        head = file.read(HEADER)
        order = {b"IM": "<", b"MI": ">"}.get(head[126:128])
        if not head.startswith(b"MATLAB 5") or order is None:
            file.seek(0)
            yield io.BytesIO(file.read())
            return
        while tag := file.read(8):
            size = struct.unpack(f"{order}II", tag)[1] if len(tag) == 8 else 0
            yield io.BytesIO(head + tag + file.read(size))


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

    def take(self, name: str, value: Any) -> None:
        """Take a variable of the top level; an object carries its name inside."""
        if isinstance(value, MatlabOpaque):
            name = _part(value, "s0") or name
        self._take("", name, value)

    def _take(self, container: str, name: str, value: Any) -> None:
        full = f"{container}.{name}" if container else name
        if isinstance(value, MatlabOpaque):
            self.faults.append(_remedy(full, _part(value, "s2") or "object"))
        elif isinstance(value, MatlabFunction):
            self.faults.append(f"{full}: a function, left out; no code is run")
        elif isinstance(value, MatlabObject):
            self.faults.append(_remedy(full, getattr(value, "classname", "object")))
        elif not isinstance(value, np.ndarray):  # sparse
            self._take(container, name, value.toarray())
        elif value.dtype.names is not None:
            self._take_struct(full, value)
        elif value.dtype.kind in "OUS":
            self._take_cells(full, value)
        elif value.dtype.kind == "c":
            words = f"complex, left out; MATLAB: {name}_re = real({full}); {name}_im = imag({full})"
            self.faults.append(f"{full}: {words}")
        elif value.size:
            self.groups.setdefault(container, {})[name] = value
        else:
            self.faults.append(f"{full}: empty")

    def _take_struct(self, full: str, value: np.ndarray) -> None:
        for place, element in enumerate(value.reshape(-1)):
            here = full if value.size == 1 else f"{full}({place + 1})"
            for field in value.dtype.names or ():
                if full == "units":
                    self.units[field] = next(_texts(element[field]), "")
                else:
                    self._take(here, field, element[field])

    def _take_cells(self, full: str, value: np.ndarray) -> None:
        if value.dtype.kind in "US":
            return
        inner = [_plain(cell) for cell in value.reshape(-1)]
        if any(array is None for array in inner):
            if not all(list(_texts(cell)) for cell in value.reshape(-1)):
                self.faults.append(f"{full}: a cell array of mixed content, left out")
            return
        for i, array in enumerate(inner):
            if array is not None:
                self._take(full, f"{i + 1}", array)


def _plain(cell: Any) -> np.ndarray | None:
    """A cell that holds numbers, else None; objects are never opened."""
    good = isinstance(cell, np.ndarray) and cell.dtype.kind in "fiub" and cell.size > 1
    return cell if good else None


def _texts(value: Any) -> Iterator[str]:
    """The text that a variable holds, if it is one."""
    if isinstance(value, np.ndarray) and value.dtype.kind in "US" and value.size == 1:
        yield str(value.reshape(-1)[0])


def _part(value: MatlabOpaque, field: str) -> str:
    """Name (s0) or class (s2) of an object."""
    try:
        name = value.reshape(-1)[0][field]
    except (ValueError, IndexError, KeyError):
        return ""
    return name.decode("latin-1") if isinstance(name, bytes) else str(name)


def _remedy(full: str, kind: str) -> str:
    line = CONVERT.get(kind, ANY).format(x=full)
    return f"{full}: a MATLAB {kind}, which only MATLAB can open; there: {line}"
