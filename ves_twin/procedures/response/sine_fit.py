"""measure_response: complex gain at one frequency from recorded signals, with its uncertainty."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ves_twin.core.types import ComplexArray, FloatArray
from ves_twin.simulator.linear.response import FrequencyResponse

PARTS = 3
"""Stretches of a record that are fitted on their own; their scatter is the uncertainty."""


@dataclass(frozen=True)
class MeasuredResponse(FrequencyResponse):
    """Complex gain at frequencies, as measured.

    Attributes:
        error: standard error of the gain, relative to its magnitude (n,).
    """

    error: FloatArray

    @staticmethod
    def of(points: Sequence[tuple[float, complex, float]]) -> MeasuredResponse:
        """From rows of frequency [Hz], gain and relative standard error."""
        frequency, gain, error = zip(*points, strict=True)
        return MeasuredResponse(
            np.array(frequency, float), np.array(gain, complex), np.array(error, float)
        )


def fit_sine(time: FloatArray, values: FloatArray, frequency: float) -> ComplexArray:
    """Amplitudes X of Re(X exp(i w t)) by least squares, beside a constant and a slope.

    Args:
        time: [s] (n,).
        values: one or more signals (n,) or (n, m).
        frequency: [Hz].

    Returns:
        Complex amplitudes, () or (m,).
    """
    angle = 2.0 * np.pi * frequency * time
    middle = time - time.mean()
    columns = np.column_stack([np.cos(angle), np.sin(angle), np.ones_like(time), middle])
    found = np.linalg.lstsq(columns, values, rcond=None)[0]
    return np.asarray(found[0] - 1j * found[1])


def measure_response(
    time: FloatArray, source: FloatArray, answer: FloatArray, frequency: float
) -> tuple[complex, float]:
    """Gain answer / source at a frequency, and its standard error relative to its magnitude.

    The record is cut into PARTS; in each the fundamentals are fitted, channel by channel, and
    their ratios averaged. What is not a fundamental, harmonics and noise, shows as scatter.

    Args:
        time: [s] (n,).
        source: what drives (n,) or (n, m).
        answer: what follows, same shape.
        frequency: [Hz].
    """
    ratios = []
    for rows in np.array_split(np.arange(len(time)), PARTS):
        x = fit_sine(time[rows], source[rows], frequency)
        y = fit_sine(time[rows], answer[rows], frequency)
        ratios.append(complex(np.mean(y / x)))
    gain = complex(np.mean(ratios))
    return gain, float(np.std(ratios, ddof=1) / np.sqrt(PARTS) / abs(gain))
