"""butterworth, chebyshev, passed: sections of second order, to the bits of scipy.signal.

scipy.signal takes most of a second to import, which every process that simulates would pay.
"""

from __future__ import annotations

from functools import lru_cache
from math import asinh, sqrt

import numpy as np
from numpy.typing import NDArray

from ves_twin.core.types import FloatArray

Section = tuple[FloatArray, FloatArray]
"""Numerator (3,) and denominator (3,)."""

ORDER = np.array([-1.0, 1.0])
ROOTS = NDArray[np.complex128]


def butterworth(corner: float, rate: float) -> Section:
    """Low-pass, 3 dB down at a corner [Hz], for samples at a rate [Hz]."""
    return _section(np.zeros(0, complex), -np.exp(1j * np.pi * ORDER / 4), 1.0, corner, rate)


def chebyshev(edge: float, decibel: float, rate: float) -> Section:
    """Type 2: so many dB down from an edge [Hz] on, for samples at a rate [Hz]."""
    mu = asinh(sqrt(10 ** (0.1 * decibel) - 1)) / 2
    zeros = 1j / np.sin(ORDER * np.pi / 4)
    poles = -1 / np.sinh(mu + 1j * (np.pi * ORDER / 4))
    gain = float(np.real(np.prod(-poles) / np.prod(-zeros)))
    return _section(zeros, poles, gain, edge, rate)


def _section(zeros: ROOTS, poles: ROOTS, gain: float, at: float, rate: float) -> Section:
    """A prototype of 1 rad/s by the bilinear transform, with its frequency where it is asked."""
    warped = 4.0 * np.tan(np.pi * (2.0 * at / rate) / 2.0)
    free = len(poles) - len(zeros)
    zeros, poles, gain = warped * zeros, warped * poles, gain * warped**free
    gain = gain * np.real(np.prod(4.0 - zeros) / np.prod(4.0 - poles))
    digital = np.append((4.0 + zeros) / (4.0 - zeros), -np.ones(free))
    numerator, denominator = gain * np.poly(digital), np.poly((4.0 + poles) / (4.0 - poles))
    return np.asarray(np.real(numerator)), np.asarray(np.real(denominator))


@lru_cache(maxsize=64)
def passed(corner: float, rate: float) -> float:
    """Sd that a Butterworth section leaves of white noise of one, by its answer of a second."""
    (b0, b1, b2), (_, a1, a2) = (part.tolist() for part in butterworth(corner, rate))
    rows, x, first, second = [], 1.0, 0.0, 0.0
    for _ in range(int(rate)):
        y = first + b0 * x
        first, second, x = second + b1 * x - a1 * y, b2 * x - a2 * y, 0.0
        rows.append(y)
    return float(np.sqrt(np.sum(np.square(rows))))
