"""butterworth, chebyshev: second-order low-passes as digital filters, as scipy.signal has them.

That package takes half a second of processor time to import, before the first tick of every run.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from ves_twin.core.types import FloatArray

Section = tuple[FloatArray, FloatArray]
"""Numerator and denominator, (3,) each."""

ComplexArray = npt.NDArray[np.complex128]

ANGLES = np.pi * np.array([-1.0, 1.0]) / 4.0
"""Of the poles of second order from the negative real axis."""

TWICE = 4.0
"""Of the rate of the bilinear transform."""


def butterworth(corner: float, rate: float) -> Section:
    """Of amplitude 1/sqrt(2) at its corner: `scipy.signal.butter(2, corner, fs=rate)`.

    Args:
        corner: [Hz], below half the rate.
        rate: sampling rate [Hz].

    Source: bilinear transform of the analogue poles, pre-warped.
    """
    warped = _warped(corner, rate)
    poles = -np.exp(1j * ANGLES) * warped
    gain = warped**2 * np.real(1.0 / np.prod(TWICE - poles))
    return _section(np.array([-1.0, -1.0]), _mapped(poles), float(gain))


def chebyshev(loss: float, edge: float, rate: float) -> Section:
    """Type 2, with a notch at sqrt(2) edge: `scipy.signal.cheby2(2, loss, edge, fs=rate)`.

    Args:
        loss: at least, in the stop band [dB].
        edge: where the stop band begins [Hz]; below half the rate.
        rate: sampling rate [Hz].
    """
    ripple = 1.0 / math.sqrt(10.0 ** (0.1 * loss) - 1.0)
    mu = math.asinh(1.0 / ripple) / 2.0
    zeros, poles = 1j / np.sin(ANGLES), -1.0 / np.sinh(mu + 1j * ANGLES)
    gain = np.real(np.prod(-poles) / np.prod(-zeros))
    warped = _warped(edge, rate)
    zeros, poles = zeros * warped, poles * warped
    gain = gain * np.real(np.prod(TWICE - zeros) / np.prod(TWICE - poles))
    return _section(_mapped(zeros), _mapped(poles), float(gain))


def impulse_response(section: Section, count: int) -> FloatArray:
    """What a section gives of a 1 and zeros (count,)."""
    b, (_, a1, a2) = section[0].tolist(), section[1].tolist()
    rows, z1, z2 = [b[0]], b[1] - a1 * b[0], b[2] - a2 * b[0]
    for _ in range(count - 1):
        rows.append(z1)
        z1, z2 = z2 - a1 * z1, -a2 * z1
    return np.array(rows)


def _warped(corner: float, rate: float) -> float:
    return float(TWICE * np.tan(np.pi * (2.0 * corner / rate) / 2.0))


def _mapped(roots: ComplexArray) -> ComplexArray:
    """From the s plane to the z plane, by the bilinear transform."""
    return np.asarray((TWICE + roots) / (TWICE - roots))


def _section(zeros: FloatArray | ComplexArray, poles: ComplexArray, gain: float) -> Section:
    return gain * np.real(np.poly(zeros)), np.real(np.poly(poles))
