"""oscillation_growth: does an oscillation in a signal grow or decay, how fast, how surely."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import BoolArray, FloatArray

STOP_BAND = 100.0
"""Attenuation outside the band [dB]: a slow swing of 100 mm leaves 1 um."""

WINDOWS = 48
"""Stretches into which the signal is cut, if each then holds three oscillations."""

ABOVE_FLOOR = 4.0
"""A stretch counts from this power on, in units of the noise's."""

SURE = 3.0
"""Standard errors that a rate must be away from zero for a verdict."""


class Verdict(StrEnum):
    """What an oscillation does."""

    GROWING = "growing"
    DECAYING = "decaying"
    UNDECIDED = "undecided"


@dataclass(frozen=True)
class Growth:
    """Growth of an oscillation, a(t) = a0 exp(rate t).

    Attributes:
        rate: rate of growth [1/s], negative if it decays.
        sd: its standard error [1/s].
        frequency: strongest line in the band [Hz].
        amplitude: rms in the band at the end, in units of the signal.
        verdict: growing, decaying or undecided.
    """

    rate: float
    sd: float
    frequency: float
    amplitude: float
    verdict: Verdict


def oscillation_growth(
    values: FloatArray,
    period: float,
    band: tuple[float, float],
    floor: float | None = None,
) -> Growth:
    """Rate of growth of what oscillates within a band.

    A linear-phase band-pass takes off the slow motion. The logarithm of the power in stretches
    of time, less the noise's, is fitted by a line, or by a line that becomes level, if that is
    better (Bayesian information criterion): an oscillation that saturates has grown. The
    standard error allows for neighbouring residuals being alike, as in beats.

    Args:
        values: the signal, equally spaced (n,), or several whose powers add (n, d).
        period: time between two samples [s].
        band: lowest and highest frequency [Hz].
        floor: rms of the noise within the band; estimated from the spectrum above the band if
            left out, as white noise.

    Raises:
        InvalidInputError: a band that the sampling cannot hold, or too short a signal.
    """
    rows = np.asarray(values, dtype=float).reshape(len(values), -1)
    filtered = _band_pass(rows, period, band)
    noise = _white_power(rows, period, band) if floor is None else floor**2
    time, power = _stretches(filtered, period, band[0])
    loud = power > ABOVE_FLOOR * noise
    amplitude = float(np.sqrt(power[-1]))
    loud &= _first_run(loud)
    if np.count_nonzero(loud) < 3:
        return Growth(0.0, np.inf, float("nan"), amplitude, Verdict.UNDECIDED)
    rate, sd = _slope(time[loud], 0.5 * np.log(power[loud] - noise))
    verdict = Verdict.UNDECIDED
    if abs(rate) > SURE * sd:
        verdict = Verdict.GROWING if rate > 0.0 else Verdict.DECAYING
    return Growth(rate, sd, _line(filtered, period, band), amplitude, verdict)


def _band_pass(rows: FloatArray, period: float, band: tuple[float, float]) -> FloatArray:
    """Rows through a linear-phase band-pass, ends that it has not filled left out."""
    from scipy.signal import firwin, kaiserord, oaconvolve  # slow to import

    low, high = band
    nyquist = 0.5 / period
    if not 0.0 < low < high < nyquist:
        raise InvalidInputError("band", band, f"0 < low < high < {nyquist:.4g} Hz")
    edge = min(0.5 * low, 0.5 * (nyquist - high))
    taps, beta = kaiserord(STOP_BAND, 2.0 * edge / nyquist)
    taps |= 1
    if len(rows) < 2 * taps:
        raise InvalidInputError(
            "length of the signal", len(rows) * period, f"at least {2 * taps * period:.3g} s"
        )
    response = firwin(taps, [low, high], window=("kaiser", beta), pass_zero=False, fs=1 / period)
    centred = rows - rows.mean(axis=0)
    return np.asarray(oaconvolve(centred, response[:, None], mode="valid", axes=0))


def _white_power(rows: FloatArray, period: float, band: tuple[float, float]) -> float:
    """Power within the band of white noise as strong as the spectrum above the band."""
    from scipy.signal import welch  # slow to import

    f, density = welch(np.diff(rows, axis=0), 1.0 / period, nperseg=min(len(rows) - 1, 512), axis=0)
    above = f > band[1] + 0.5 * (0.5 / period - band[1])
    gain = 4.0 * np.sin(np.pi * f[above, None] * period) ** 2  # of the difference
    level = np.sum(np.median(density[above] / gain, axis=0))
    return float(level * (band[1] - band[0]))


def _stretches(rows: FloatArray, period: float, low: float) -> tuple[FloatArray, FloatArray]:
    """Middle [s] and mean power of each stretch."""
    size = max(len(rows) // WINDOWS, int(np.ceil(3.0 / (low * period))))
    count = len(rows) // size
    power = np.sum(rows[: count * size] ** 2, axis=1).reshape(count, size).mean(axis=1)
    time = size * period * (np.arange(count) + 0.5)
    return np.asarray(time, dtype=float), np.asarray(power)


def _first_run(loud: BoolArray) -> BoolArray:
    """What follows a stretch lost in noise after a loud beginning is noise, too."""
    if not loud[0] or loud.all():
        return np.ones_like(loud)
    mask = np.zeros_like(loud)
    mask[: int(np.argmin(loud))] = True
    return mask


def _slope(time: FloatArray, level: FloatArray) -> tuple[float, float]:
    """Slope of a line, or of the rise of a line that becomes level, and its standard error."""
    best = _fit(time, level, time[-1])
    if len(time) >= 8:
        for corner in time[3:-3]:
            other = _fit(time, level, corner, extra=1)
            if other.criterion < best.criterion - 2.0:
                best = other
    return best.slope, best.error


@dataclass(frozen=True)
class _Line:
    slope: float
    error: float
    criterion: float


def _fit(time: FloatArray, level: FloatArray, corner: float, extra: int = 0) -> _Line:
    """Least squares of level = a + slope min(t, corner)."""
    n = len(time)
    design = np.column_stack([np.ones(n), np.minimum(time, corner)])
    solution, *_ = np.linalg.lstsq(design, level, rcond=None)
    residual = level - design @ solution
    variance = max(float(residual @ residual) / max(n - 2 - extra, 1), 1e-12)
    alike = float(residual[1:] @ residual[:-1]) / max(float(residual @ residual), 1e-30)
    alike = min(max(alike, 0.0), 0.9)
    spread = np.linalg.inv(design.T @ design)[1, 1] * variance * (1.0 + alike) / (1.0 - alike)
    return _Line(
        float(solution[1]), float(np.sqrt(spread)), n * np.log(variance) + extra * np.log(n)
    )


def _line(rows: FloatArray, period: float, band: tuple[float, float]) -> float:
    """Frequency of the strongest line, to a fraction of the resolution [Hz]."""
    padded = 1 << int(np.ceil(np.log2(8 * len(rows))))
    tapered = rows * np.hanning(len(rows))[:, None]
    power = np.sum(np.abs(np.fft.rfft(tapered, padded, axis=0)) ** 2, axis=1)
    f = np.fft.rfftfreq(padded, period)
    return float(f[np.argmax(np.where((f >= band[0]) & (f <= band[1]), power, 0.0))])
