"""npz_log: arrays of NumPy files; objects, which are pickles, are refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ves_twin.core.errors import InvalidInputError, one_line
from ves_twin.data.array_log import ArrayLog

PICKLE = "a pickle: reading it can run code that it holds"


def npz_log(path: Path) -> ArrayLog:
    """An npz or npy file as a log; nothing is ever unpickled.

    Raises:
        InvalidInputError: objects only, or a damaged file.
    """
    arrays, faults = {}, []
    try:
        loaded = np.load(path, allow_pickle=False)
        if isinstance(loaded, np.ndarray):
            loaded = {path.stem: loaded}
        names = list(loaded)
    except Exception as error:  # zipfile, zlib, tokenize and numpy each raise their own
        raise InvalidInputError(path.name, _words(error), "arrays of numbers") from None
    for name in names:
        try:
            array = loaded[name]
        except Exception as error:  # as above
            faults.append(f"{name}: {_words(error)}, left out")
            continue
        if not isinstance(array, np.ndarray):
            faults.append(f"{name}: no array, left out")
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
    return ArrayLog(path, "NumPy", {"": arrays}, faults=faults)


def _words(error: BaseException) -> str:
    return PICKLE if "pickle" in str(error) else f"damaged: {one_line(error)}"
