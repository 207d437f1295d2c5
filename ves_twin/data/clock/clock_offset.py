"""clock_offset: by how much one recorder's clock is behind another's, from what both saw."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.signal import coherence, correlate, csd, firwin, oaconvolve

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.core.without_line import without_line

ALIKE = 0.6
"""Correlation below which two columns did not see the same motion."""

LONELY = 0.95
"""A second peak as high as this share of the first makes the offset a guess among several."""

SHARED = 0.99
"""Share of the cross-spectrum that the band of a fit holds."""

MOST = 2_000_000
"""Rows of the correlation at most."""

FEWEST = 32
"""Rows that must overlap."""


@dataclass(frozen=True)
class ClockOffset:
    """What is added to a clock's readings to get the main clock's [s].

    Attributes:
        value: the offset.
        sd: its standard deviation, from what the two columns do not share.
        correlation: of the two columns there.
        rival: height of the next peak as a share of this one.
        drift: how fast the offset grows, from the halves of the overlap; sd beside it [s/s].
        drift_sd: its standard deviation.
    """

    value: float
    sd: float
    correlation: float
    rival: float
    drift: float
    drift_sd: float

    @property
    def unique(self) -> bool:
        """Whether no other offset would do nearly as well."""
        return self.rival < LONELY

    @property
    def drifts(self) -> bool:
        """Whether the two clocks clearly run at different rates."""
        return abs(self.drift) > 5.0 * self.drift_sd


def clock_offset(
    own_time: FloatArray,
    own: FloatArray,
    main_time: FloatArray,
    main: FloatArray,
    search: float,
) -> ClockOffset:
    """Estimate the offset d with own(t) = a + g main(t + d).

    The cross-correlation of the two over the power of the overlap gives whole rows. Both are
    smoothed to the band in which they are coherent, for the slope of noise tells no time; then a,
    g and d are fitted by Gauss-Newton. The sd of d comes from the residual times the slope with its
    autocorrelation counted (Newey and West 1987), since residuals of motion are coloured.

    Args:
        own_time: times on the other clock [s] (k,), increasing.
        own: a column there (k,), NaN left out.
        main_time: times on the main clock [s] (n,).
        main: a column that saw the same motion (n,).
        search: largest offset that is looked for [s].

    Raises:
        InvalidInputError: no motion, no overlap, or columns that are not alike.
    """
    a_time, a = own_time[np.isfinite(own)], own[np.isfinite(own)]
    b_time, b = main_time[np.isfinite(main)], main[np.isfinite(main)]
    if min(len(a), len(b)) < FEWEST or np.ptp(a) == 0.0 or np.ptp(b) == 0.0:
        raise InvalidInputError("columns to align by", "no motion", "two that saw the same motion")
    span = max(a_time[-1] - a_time[0], b_time[-1] - b_time[0])
    step = max(float(min(np.median(np.diff(a_time)), np.median(np.diff(b_time)))), span / MOST)
    coarse, height, rival = _coarse(a_time, a, b_time, b, step, search)
    if abs(height) < ALIKE:
        came = f"a correlation of {abs(height):.2f} at best"
        raise InvalidInputError("columns to align by", came, f"at least {ALIKE}")
    band = _band(a_time + coarse, a, b_time, b, step)
    a, b = _smooth(a_time, a, band), _smooth(b_time, b, band)
    value, sd, correlation = _refined(a_time, a, b_time, b, coarse, band)
    middle = 0.5 * (max(a_time[0], b_time[0] - value) + min(a_time[-1], b_time[-1] - value))
    early, late = a_time < middle, a_time >= middle
    drift, drift_sd = 0.0, np.inf
    if min(early.sum(), late.sum()) >= 2 * FEWEST:
        first, sd_first, _ = _refined(a_time[early], a[early], b_time, b, value, band)
        second, sd_second, _ = _refined(a_time[late], a[late], b_time, b, value, band)
        apart = float(a_time[late].mean() - a_time[early].mean())
        drift, drift_sd = (second - first) / apart, float(np.hypot(sd_first, sd_second)) / apart
    return ClockOffset(value, sd, correlation, rival, drift, drift_sd)


def _coarse(
    a_time: FloatArray,
    a: FloatArray,
    b_time: FloatArray,
    b: FloatArray,
    step: float,
    search: float,
) -> tuple[float, float, float]:
    """Offset to a row, correlation there, and the next peak as a share of it."""
    grid_a = np.arange(a_time[0], a_time[-1], step)
    grid_b = np.arange(b_time[0], b_time[-1], step)
    x, y = without_line(np.interp(grid_a, a_time, a)), without_line(np.interp(grid_b, b_time, b))
    ones_x, ones_y = np.ones(len(x)), np.ones(len(y))
    cross = correlate(y, x, method="fft")
    power = correlate(y**2, ones_x, method="fft") * correlate(ones_y, x**2, method="fft")
    overlap = correlate(ones_y, ones_x, method="fft")
    shape = cross / np.sqrt(np.maximum(power, 1e-9 * power.max()))
    lags = np.arange(1 - len(x), len(y))
    offsets = grid_b[0] - grid_a[0] + lags * step
    room = min(len(x), len(y))
    allowed = (np.abs(offsets) <= search) & (overlap > max(FEWEST, 0.3 * room))
    if not allowed.any():
        came = f"no overlap within {search:g} s"
        raise InvalidInputError("clocks to align", came, "a larger search, or an offset in seconds")
    size = np.where(allowed, np.abs(shape), 0.0)
    best = int(np.argmax(size))
    below = np.flatnonzero(size < 0.5 * size[best])
    left = below[below < best].max(initial=0)
    right = below[below > best].min(initial=len(size) - 1)
    rest = np.concatenate([size[:left], size[right + 1 :]])
    rival = float(rest.max(initial=0.0) / max(size[best], 1e-300))
    return float(offsets[best]), float(shape[best]), rival


def _band(
    a_time: FloatArray, a: FloatArray, b_time: FloatArray, b: FloatArray, step: float
) -> float:
    """Frequency below which nearly all that the two share lies [Hz]."""
    grid = np.arange(max(a_time[0], b_time[0]), min(a_time[-1], b_time[-1]), step)
    x, y = np.interp(grid, a_time, a), np.interp(grid, b_time, b)
    length = max(FEWEST, len(grid) // 8)
    if len(grid) < 2 * length:
        return 0.5 / step
    frequency, cross = csd(x, y, 1.0 / step, nperseg=length)
    shared = np.abs(cross) * (coherence(x, y, 1.0 / step, nperseg=length)[1] > 0.5)
    if not shared.any():
        return 0.5 / step
    share = np.cumsum(shared) / shared.sum()
    return float(frequency[np.searchsorted(share, SHARED)] + frequency[1])


def _smooth(time: FloatArray, values: FloatArray, band: float) -> FloatArray:
    """A zero-phase low-pass at twice the band, on an even grid; back on the rows."""
    step = float(np.median(np.diff(time)))
    if 2.0 * band > 0.4 / step:
        return values
    grid = time[0] + np.arange(round((time[-1] - time[0]) / step) + 1) * step
    half = min(round(1.0 / (band * step)), len(grid) - 1)
    window = firwin(2 * half + 1, 2.0 * band, fs=1.0 / step)
    padded = np.pad(np.interp(grid, time, values), half, mode="reflect", reflect_type="odd")
    return np.asarray(np.interp(time, grid, oaconvolve(padded, window, mode="valid")))


def _refined(
    a_time: FloatArray,
    a: FloatArray,
    b_time: FloatArray,
    b: FloatArray,
    offset: float,
    band: float,
) -> tuple[float, float, float]:
    curve = CubicSpline(b_time, b)
    sd, correlation = np.inf, 0.0
    for _ in range(8):
        there = a_time + offset
        inside = (there > b_time[0]) & (there < b_time[-1])
        y, model, slope = a[inside], curve(there[inside]), curve(there[inside], 1)
        basis = np.column_stack([np.ones(len(y)), model])
        gain = np.linalg.lstsq(basis, y, rcond=None)[0]
        tangent = gain[1] * slope
        tangent = tangent - basis @ np.linalg.lstsq(basis, tangent, rcond=None)[0]
        residual = y - basis @ gain
        power = float(tangent @ tangent)
        if power == 0.0:
            break
        offset += float(tangent @ residual) / power
        memory = 2.0 / (band * float(np.median(np.diff(a_time))))
        sd = _sd(tangent, residual - tangent * float(tangent @ residual) / power, power, memory)
        correlation = float(np.corrcoef(y, model)[0, 1])
    return float(offset), sd, correlation


def _sd(tangent: FloatArray, residual: FloatArray, power: float, memory: float) -> float:
    """Newey-West sd of the least-squares step; `memory` is that of the smoothing [rows]."""
    score = tangent * residual
    reach = min(len(score) // 4, int(max(8.0 * len(score) ** (1.0 / 3.0), memory)))
    spectrum = np.abs(np.fft.rfft(score, 2 * len(score))) ** 2
    covariance = np.fft.irfft(spectrum)[: reach + 1]
    weights = 1.0 - np.arange(reach + 1) / (reach + 1)
    variance = covariance[0] + 2.0 * float(weights[1:] @ covariance[1:])
    floor = 0.1 * covariance[0]
    return float(np.sqrt(max(variance, floor)) / power)
