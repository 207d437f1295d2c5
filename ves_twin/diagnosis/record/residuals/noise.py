"""Noise: what a column shows where nothing is wrong: size, colour, slow part, and who says so."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from ves_twin.core.recording.recording import Recording
from ves_twin.core.types import FloatArray

REST = 1.0
"""Time after the last change of a set-point until the rig counts as standing [s]: a dozen time
constants of the legs at 12.6 /s (thesis 5.2)."""

SHORTEST = 2.0
"""A shorter standstill tells no noise [s]."""

SILENT = 1e-3
"""Share of its declared power below which a standing column tells nothing (an encoder)."""

BAND_POINTS = 48
"""Frequencies in a band at which the powers of two noises are added."""


class NoiseSource(StrEnum):
    """Who says how large the noise is."""

    STILL = "still"
    STANDSTILL = "standstill"
    DECLARED = "declared"
    NOBODY = "nobody"


@dataclass(frozen=True)
class Noise:
    """Noise of one column at the rows of a recording.

    Attributes:
        sd: of one row, without the slow part.
        colour: autocorrelation at lags 1, 2, ... of that; beyond it is zero.
        slow: sd of a slow part, an Ornstein-Uhlenbeck process.
        slow_time: its correlation time [s].
        offset: sd of a constant that each recording has anew, for instance from zeroing.
        source: who says so.
        louder: factor on the power of `colour` in each of as many equal bands up to Nyquist.
    """

    sd: float
    colour: tuple[float, ...]
    slow: float
    slow_time: float
    offset: float
    source: NoiseSource
    louder: tuple[float, ...] = (1.0,)

    def spectrum(self, frequency: FloatArray, period: float) -> FloatArray:
        """Power at frequencies [Hz] (f,), normalised so that its mean up to Nyquist is variance.

        Args:
            frequency: up to half the rate of the rows [Hz].
            period: of the rows [s].
        """
        angle = 2.0 * np.pi * frequency * period
        grid = (np.arange(480) + 0.5) * np.pi / 480
        power = self.sd**2 * self._shape(angle) / np.mean(self._shape(grid))
        if self.slow > 0.0:
            a = np.exp(-period / self.slow_time)
            power += self.slow**2 * (1.0 - a**2) / np.abs(1.0 - a * np.exp(-1j * angle)) ** 2
        return np.asarray(power)

    def _shape(self, angle: FloatArray) -> FloatArray:
        shape = np.ones_like(angle)
        for lag, value in enumerate(self.colour, 1):
            shape += 2.0 * value * np.cos(lag * angle)
        count = len(self.louder)
        band = np.minimum((angle / np.pi * count).astype(np.int64), count - 1)
        factor = np.array(self.louder)[band]
        return np.asarray(np.maximum(shape, 0.02) * factor)  # a floor: estimates may dip below 0

    def mean_sd(self, count: int) -> float:
        """Sd of the mean of so many rows."""
        inflation = max(1.0 + 2.0 * sum(self.colour), 0.02)
        return float(np.sqrt(self.sd**2 * inflation / max(count, 1) + self.offset**2))


def noise_of_difference(one: Noise, other: Noise) -> Noise:
    """Noise of a column of one recording less that of another: powers add, band by band.

    Args:
        one: of one recording.
        other: of the other, at rows of the same rate, independent.

    Returns:
        Nothing told where one of them is told by nobody.
    """
    if not (one.sd > 0.0 and other.sd > 0.0):
        return one if not one.sd > 0.0 else other
    share = one.sd**2 / (one.sd**2 + other.sd**2)
    lags = max(len(one.colour), len(other.colour))
    padded = [np.pad(np.array(n.colour, float), (0, lags - len(n.colour))) for n in (one, other)]
    colour = tuple(map(float, share * padded[0] + (1.0 - share) * padded[1]))
    both = Noise(
        sd=float(np.hypot(one.sd, other.sd)),
        colour=colour,
        slow=float(np.hypot(one.slow, other.slow)),
        slow_time=one.slow_time,
        offset=float(np.hypot(one.offset, other.offset)),
        source=one.source if one.source is other.source else NoiseSource.DECLARED,
    )
    bands = max(len(one.louder), len(other.louder))
    frequency = (np.arange(BAND_POINTS * bands) + 0.5) / (2 * BAND_POINTS * bands)
    fast = [replace(n, slow=0.0).spectrum(frequency, 1.0) for n in (one, other, both)]
    power = [each.reshape(bands, BAND_POINTS).mean(axis=1) for each in fast]
    return replace(both, louder=tuple(map(float, (power[0] + power[1]) / power[2])))


def standing_rows(recording: Recording, setpoints: Iterable[str]) -> slice | None:
    """The longest stretch in which no set-point changes, less REST at its begin; None if short.

    Args:
        recording: on an even clock.
        setpoints: inputs that do not answer to the run.
    """
    moved = np.zeros(len(recording), dtype=bool)
    for name in setpoints:
        moved[1:] |= np.any(np.diff(recording[name], axis=0) != 0.0, axis=1)
    period = float(np.median(np.diff(recording.time)))
    edges = np.concatenate([[0], np.flatnonzero(moved), [len(recording)]])
    longest = int(np.argmax(np.diff(edges)))
    first = int(edges[longest]) + (0 if edges[longest] == 0 else round(REST / period))
    stop = int(edges[longest + 1])
    return slice(first, stop) if (stop - first) * period >= SHORTEST else None


def measured_noise(rows: FloatArray, declared: Noise, source: NoiseSource) -> Noise:
    """Noise of a column (n,) that stands still, less a line; the slow part stays as declared.

    A column without noise of its own, such as an encoder that shows one count, keeps what is
    declared.
    """
    rows = rows[np.isfinite(rows)]
    if len(rows) < 20:
        return declared
    line = np.vander(np.linspace(-1.0, 1.0, len(rows)), 2)
    rest = rows - line @ np.linalg.lstsq(line, rows, rcond=None)[0]
    power = float(rest @ rest) / (len(rest) - 2)
    if not power > SILENT * declared.sd**2:
        return declared
    first = float(np.clip(rest[:-1] @ rest[1:] / (rest @ rest), -0.9, 0.9))
    colour = tuple(first**k for k in range(1, 9))
    return Noise(np.sqrt(power), colour, declared.slow, declared.slow_time, declared.offset, source)
