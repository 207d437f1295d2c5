"""ChannelComparison: one measured column against what was expected of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ves_twin.core.types import BoolArray, FloatArray
from ves_twin.diagnosis.model.grid import AnalysisGrid
from ves_twin.diagnosis.record.residuals.cells import Cell, bands, blocks, regimes
from ves_twin.diagnosis.record.residuals.coherence import Coherence, Companions
from ves_twin.diagnosis.record.residuals.lag import Lag, find_lag
from ves_twin.diagnosis.record.residuals.noise import Noise, NoiseSource
from ves_twin.diagnosis.record.residuals.spectrum import SPREADS, Power

LOUD = 5.0
"""Score beyond which a cell is more than noise; a Gaussian cell passes it with 3e-7."""

FAR = 5.0
"""Sd beyond which a mean is more than noise and zeroing."""


@dataclass(frozen=True)
class Whiteness:
    """Lag-one correlation of the residual, that of its noise, and the spread between the two."""

    lag_one: float
    expected: float
    spread: float

    @property
    def white(self) -> bool:
        """Whether the residual has no other colour than its noise."""
        return abs(self.lag_one - self.expected) <= SPREADS * self.spread


@dataclass(frozen=True)
class ChannelComparison:
    """One column.

    Attributes:
        name: column, numbered from 1.
        signal: its signal.
        column: its place in that signal, from 0.
        axis: what it is, for instance "leg 3".
        unit: SI unit of rms, peak, mean and sigma.
        sigma: sd of the noise of one row; zero where nobody tells it.
        noise: who says so.
        rms: of measured less simulated.
        rms_slow: of that on the analysis grid, where no hole reaches.
        peak: its largest size.
        mean: of it.
        mean_score: mean over the sd that noise and zeroing give it.
        unexplained: residual's share of the measured variance; None where nothing moves.
        missing: share of the rows without a number.
        whiteness: None where it cannot be told.
        lag: of measured behind simulated; None where the motion cannot tell.
        coherence: with the drive; None where nothing is driven.
        bands: by frequency.
        blocks: by time.
        regimes: by velocity, position and load.
    """

    name: str
    signal: str
    column: int
    axis: str
    unit: str
    sigma: float
    noise: NoiseSource
    rms: float
    rms_slow: float
    peak: float
    mean: float
    mean_score: float
    unexplained: float | None
    missing: float
    whiteness: Whiteness | None
    lag: Lag | None
    coherence: Coherence | None
    bands: tuple[Cell, ...]
    blocks: tuple[Cell, ...]
    regimes: tuple[Cell, ...]

    @property
    def rms_sigma(self) -> float:
        """Rms in sigma; NaN where nobody tells the noise."""
        return self._in_sigma(self.rms)

    @property
    def loudness(self) -> float:
        """Rms in sigma, to sort by: zero where nobody tells the noise."""
        return self.rms_sigma if self.sigma > 0.0 else 0.0

    @property
    def loudest(self) -> Cell | None:
        """The band or stretch with the highest score."""
        return max((*self.bands, *self.blocks), key=lambda cell: cell.score, default=None)

    @property
    def beyond_noise(self) -> bool:
        """Whether a band, a stretch or the mean is more than noise and zeroing."""
        top = self.loudest
        return abs(self.mean_score) > FAR or (top is not None and top.score > LOUD)

    def to_dict(self) -> dict[str, object]:
        """Plain values for JSON."""
        from dataclasses import asdict

        top = self.loudest
        return {
            **asdict(self),
            "rms_sigma": self.rms_sigma,
            "peak_sigma": self._in_sigma(self.peak),
            "mean_sigma": self._in_sigma(self.mean),
            "white": self.whiteness.white if self.whiteness else None,
            "beyond_noise": self.beyond_noise,
            "loudest": asdict(top) if top else None,
        }

    def _in_sigma(self, value: float) -> float:
        return value / self.sigma if self.sigma > 0.0 else float("nan")


@dataclass(frozen=True)
class Column:
    """A column that is compared: its names, noise, grid, and the input column that leads it.

    `rate` is that of the analysis grid [Hz]; None for poses at rest, which have neither
    frequencies nor lags.
    """

    name: str
    signal: str
    index: int
    axis: str
    unit: str
    noise: Noise
    rate: float | None
    leader: tuple[str, FloatArray] | None = None


def compare_column(
    column: Column,
    time: FloatArray,
    measured: FloatArray,
    expected: FloatArray,
    companions: Companions,
    load: FloatArray | None,
) -> ChannelComparison | None:
    """Compare one column.

    Args:
        column: what it is.
        time: even clock [s] (n,).
        measured: rows (n,), NaN where missing.
        expected: rows (n,), of a simulation or of another recording.
        companions: columns of the drive and their rates.
        load: size of the force on the sensor (n,).

    Returns:
        None if fewer than half of the rows hold numbers.
    """
    residual = measured - expected
    good = np.isfinite(residual)
    share = float(np.mean(good))
    if share < 0.5:
        return None
    period = float(time[1] - time[0])
    kept, noise = residual[good], column.noise
    mean = float(np.mean(kept))
    filled = np.where(good, residual - mean, 0.0)  # filled rows add no power
    told, moves = noise.sd > 0.0, column.rate is not None
    power = Power(filled, noise, period, share) if told and moves else None
    white = power.whiteness() if power else None
    coherence = companions.of(filled) if moves else None
    leader = column.leader
    if leader is None and coherence is not None and coherence.told:
        leader = (coherence.column, companions.rows(coherence.column))
    moved = float(np.var(measured[good]))
    at = np.arange(len(time))
    whole = np.interp(at, at[good], measured[good])
    return ChannelComparison(
        name=column.name,
        signal=column.signal,
        column=column.index,
        axis=column.axis,
        unit=column.unit,
        sigma=noise.sd,
        noise=noise.source,
        rms=float(np.sqrt(np.mean(kept**2))),
        rms_slow=_slow(residual, good, period, column.rate),
        peak=float(np.max(np.abs(kept))),
        mean=mean,
        mean_score=mean / noise.mean_sd(len(kept)) if told else 0.0,
        unexplained=float(np.var(kept)) / moved if moved > 4.0 * noise.sd**2 else None,
        missing=1.0 - share,
        whiteness=Whiteness(*white) if white else None,
        lag=find_lag(whole, np.where(np.isfinite(expected), expected, whole), period)
        if moves
        else None,
        coherence=coherence,
        bands=bands(power) if power else (),
        blocks=blocks(time, residual, noise) if told else (),
        regimes=regimes(residual, noise, leader, load) if told else (),
    )


def _slow(residual: FloatArray, good: BoolArray, period: float, rate: float | None) -> float:
    """Rms on the analysis grid, without the rows that a hole goes into."""
    grid = AnalysisGrid(period, 1) if rate is None else AnalysisGrid.of(period, rate)
    at = np.arange(len(residual))
    filled = np.where(good, residual, np.interp(at, at[good], residual[good]))
    slow = grid.reduce(filled[:, None])[:, 0]
    touched = grid.touched(~good[:, None])[:, 0]
    kept = slow if touched.all() or good.all() else slow[~touched]
    return float(np.sqrt(np.mean(np.square(kept, dtype=float)))) if len(kept) else float("nan")
