"""shifted: a signal some time ago."""

from __future__ import annotations

import numpy as np

from ves_twin.core.types import FloatArray


def shifted(values: FloatArray, time: FloatArray, delay: float) -> FloatArray:
    """Values (n,) or (n, w) a delay [s] ago, linear between rows, ends held."""
    if delay == 0.0:
        return values
    if values.ndim == 1:
        return np.asarray(np.interp(time - delay, time, values))
    return np.stack([np.interp(time - delay, time, column) for column in values.T], axis=1)
