"""npz_log: arrays of NumPy files; objects, which are pickles, are refused."""

from __future__ import annotations

import math
import warnings
import zipfile
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from typing import IO

from numpy.lib import format as npy

from ves_twin.core.errors import InvalidInputError, VesTwinError, one_line
from ves_twin.data.formats.array_log import ArrayLog
from ves_twin.data.formats.limits import Limits

PICKLE = "a pickle: reading it can run code that it holds"


def npz_log(path: Path, limits: Limits | None = None) -> ArrayLog:
    """An npz or npy file as a log; nothing is ever unpickled.

    Raises:
        InvalidInputError: objects only, a damaged file, or more numbers than it may unfold to.
    """
    limits = limits or Limits()
    arrays, faults = {}, []
    size = 0
    with ExitStack() as stack:
        try:
            members = list(_members(path, stack))
        except Exception as error:  # zipfile raises several kinds
            raise InvalidInputError(path.name, _words(error), "arrays of numbers") from None
        for name, member in members:
            try:
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore")  # the header is parsed as Python's own text
                    with member() as stream:
                        size += _claimed(stream)
                    limits.check_unfolded(path, size)
                    with member() as stream:
                        array = npy.read_array(stream, allow_pickle=False)
            except VesTwinError:
                raise
            except Exception as error:  # zipfile, zlib, tokenize and numpy each raise their own
                faults.append(f"{name}: {_words(error)}, left out")
                continue
            parts = {name: array}
            if array.dtype.names is not None:
                parts = {f"{name}.{field}": array[field] for field in array.dtype.names}
            for part, values in parts.items():
                if values.dtype.kind in "fiub" and values.size:
                    arrays[part] = values
                else:
                    faults.append(f"{part}: {values.dtype} of shape {values.shape}, left out")
    if not arrays:
        raise InvalidInputError(path.name, "; ".join(faults) or "0 arrays", "arrays of numbers")
    return ArrayLog(path, "NumPy", {"": arrays}, faults=faults, limits=limits)


def _members(path: Path, stack: ExitStack) -> Iterator[tuple[str, Callable[[], IO[bytes]]]]:
    """Names of the arrays and what opens them."""
    if not zipfile.is_zipfile(path):
        yield path.stem, lambda: path.open("rb")
        return
    archive = stack.enter_context(zipfile.ZipFile(path))
    for name in archive.namelist():
        yield name.removesuffix(".npy"), partial(archive.open, name)


def _claimed(stream: IO[bytes]) -> int:
    """Bytes that the header of an array claims, which numpy would take before it reads."""
    first = npy.read_magic(stream) == (1, 0)
    shape, _, kind = (npy.read_array_header_1_0 if first else npy.read_array_header_2_0)(stream)
    return math.prod(shape) * max(kind.itemsize, 1)


def _words(error: BaseException) -> str:
    return PICKLE if "pickle" in str(error) else f"damaged: {one_line(error)}"
