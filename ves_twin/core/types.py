"""Types: the array aliases that signatures share."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
SingleArray = NDArray[np.float32]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]
Block = np.ndarray[tuple[int, ...], np.dtype[np.void]]
"""One-element structured array: parameters or state of a compiled kernel, by name."""
Record = Any
"""A structured scalar as a compiled kernel sees it: fields by attribute."""
