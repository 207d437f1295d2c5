"""AnalysisGrid: where residuals live: anti-aliased, about 100 Hz, single precision."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import signal

from ves_twin.core.types import BoolArray, FloatArray, SingleArray

RATE = 100.0
"""Analysis rate aimed at [Hz]: the rig's modes end near 40 Hz (thesis 5.2)."""


@dataclass(frozen=True)
class AnalysisGrid:
    """Every `factor`-th row behind a linear-phase low-pass with its corner at the new Nyquist rate.

    The filter has 10 * factor + 1 taps; rows that it cannot fill at the two ends are dropped. At
    the corner it is 6 dB down, so what folds back is down as much and the floor stays near white.

    Attributes:
        period: of the rows that come [s].
        factor: rows per row of the grid.
    """

    period: float
    factor: int

    @staticmethod
    def of(period: float, rate: float = RATE) -> AnalysisGrid:
        """The grid nearest to a rate [Hz] below that of the data."""
        return AnalysisGrid(period, max(1, round(1.0 / (rate * period))))

    @property
    def step(self) -> float:
        """Time between rows of the grid [s]."""
        return self.period * self.factor

    @cached_property
    def taps(self) -> FloatArray:
        """The low-pass (10 * factor + 1,); a single 1 where nothing is left out."""
        if self.factor == 1:
            return np.ones(1)
        return np.asarray(signal.firwin(10 * self.factor + 1, 1.0 / self.factor))

    def reduce(self, rows: FloatArray) -> SingleArray:
        """Channels on the grid (m, c) from channels at the data's rows (n, c)."""
        if self.factor == 1:
            return np.asarray(rows, np.float32)
        filtered = signal.fftconvolve(rows, self.taps[:, None], mode="valid", axes=0)
        return np.asarray(filtered[:: self.factor], np.float32)

    def touched(self, rows: BoolArray) -> BoolArray:
        """Rows of the grid (m, c) that any marked row of the data (n, c) goes into."""
        ones = np.ones((len(self.taps), 1))
        spread = signal.fftconvolve(rows.astype(float), ones, mode="valid", axes=0) > 0.5
        return np.asarray(spread[:: self.factor])

    def times(self, time: FloatArray) -> FloatArray:
        """Times [s] of the grid's rows (m,)."""
        margin = len(self.taps) // 2
        return np.asarray(time[margin : len(time) - margin][:: self.factor])

    def autocovariance(self, sd: float, lags: int, corner: float | None = None) -> FloatArray:
        """Autocovariance (lags + 1,) on the grid of noise of a given sd per row.

        White from row to row, or white that went through a Butterworth low-pass of second order:
        r(t) = sd^2 exp(-w |t|) (cos w t + sin w |t|), w = sqrt(2) pi corner.
        """
        full = np.correlate(self.taps, self.taps, mode="full")
        middle, reach = len(self.taps) - 1, lags * self.factor
        shifts = np.arange(-middle - reach, middle + reach + 1)
        if corner is None:
            rows = (shifts == 0).astype(float)
        else:
            phase = np.sqrt(2.0) * np.pi * corner * self.period * np.abs(shifts)
            rows = np.exp(-phase) * (np.cos(phase) + np.sin(phase))
        smoothed = np.convolve(rows, full, mode="valid")
        return np.asarray(sd**2 * smoothed[reach :: self.factor][: lags + 1])
