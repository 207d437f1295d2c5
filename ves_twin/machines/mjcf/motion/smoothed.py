"""smoothed: a column behind the low-pass that stands before every differentiation."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from scipy.signal import butter, sosfiltfilt

from ves_twin.core.types import FloatArray

ORDER = 4
"""Of the Butterworth low-pass before differentiation, run forth and back: no phase."""

BEYOND, TOLD = 2.0, 1.0
"""Periods of its corner by which a column is continued beyond its ends before the low-pass, and of
which it is continued as a parabola: a motion that a log cuts off has its acceleration there. Where
scipy turns 15 rows about the end, the first period was off by twice the acceleration (sin 2 t
below 5 Hz), now by a tenth; half a period follows faster motions, and triples white noise there."""

FEWEST = 3
"""Numbers of a parabola."""


def smoothed(column: FloatArray, period: float, corner: float) -> FloatArray:
    """A column (n,) behind a low-pass [Hz] without phase; as it is where the corner is too high."""
    share = 2.0 * corner * period
    if share >= 0.9:
        return column
    beyond = math.ceil(BEYOND / (corner * period))
    count = min(math.ceil(TOLD / (corner * period)) + FEWEST, len(column))
    before, after = (_onward(end[-count:], beyond) for end in (column[::-1], column))
    whole = np.concatenate([before[::-1], column, after])
    return np.asarray(sosfiltfilt(_low_pass(share), whole, padlen=beyond)[beyond:-beyond])


def _onward(column: FloatArray, beyond: int) -> FloatArray:
    """Rows after the last of a column (n,), by the parabola nearest to it (beyond,)."""
    fit, powers = _parabola(len(column), beyond)
    return np.asarray(powers @ (fit @ column))


@lru_cache
def _parabola(count: int, beyond: int) -> tuple[FloatArray, FloatArray]:
    """Numbers of the parabola nearest to a count of rows (p, count), and its next rows of these."""
    powers = np.vander(np.arange(1.0 - count, beyond + 1.0) / count, min(FEWEST, count))
    return np.asarray(np.linalg.pinv(powers[:count]), float), powers[count:]


@lru_cache
def _low_pass(share: float) -> FloatArray:
    """Sections of a corner as a share of half the rate; its design takes longer than its use."""
    return np.asarray(butter(ORDER, share, output="sos"), float)
