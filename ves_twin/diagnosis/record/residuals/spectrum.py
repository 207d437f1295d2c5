"""Power: energy of a residual against that of its noise, in bands, and how white it is."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.record.residuals.noise import Noise

HANN = 2.0 / 3.0
"""Share of the bins of a Hann window that are independent: 18/35 to 2/3 by the band; and the
spread of a sum over bins grows by its inverse root."""

WHITE_FROM = 1.0
"""Whiteness is judged above this frequency [Hz], where slow drift has no part."""

KNOWN = 0.1
"""Share to which the power of noise is known: what a standstill of 20 s tells of a band."""

SPREADS = 4.0
"""A colour so many spreads from that of the noise is another one."""


def score(ratio: float, degrees: float, known: float = KNOWN) -> float:
    """Standard normal score of a mean square over its expectation (Wilson and Hilferty 1931).

    (chi^2 / m)^(1/3) is nearly normal with mean 1 - 2 / (9 m) and variance 2 / (9 m).

    Args:
        ratio: of the two.
        degrees: of freedom.
        known: share to which the expectation itself is known.
    """
    spread = 2.0 / (9.0 * degrees)
    return float((np.cbrt(ratio) - (1.0 - spread)) / np.sqrt(spread + (known / 3.0) ** 2))


@dataclass(frozen=True)
class Power:
    """Periodogram of a residual beside the expected one.

    Attributes:
        residual: rows (n,), finite, mean removed.
        noise: of the column.
        period: of the rows [s].
        share: of the rows that were measured; the rest is filled and carries no information.
    """

    residual: FloatArray
    noise: Noise
    period: float
    share: float = 1.0

    @cached_property
    def frequency(self) -> FloatArray:
        """Bins [Hz] above zero."""
        return np.asarray(np.fft.rfftfreq(len(self.residual), self.period)[1:], dtype=float)

    @cached_property
    def found(self) -> FloatArray:
        """Power of the residual in each bin, normalised as `Noise.spectrum`."""
        window = np.hanning(len(self.residual))
        spectrum = np.fft.rfft(self.residual * window)[1:]
        return np.asarray(np.abs(spectrum) ** 2 / np.sum(window**2) / self.share)

    @cached_property
    def expected(self) -> FloatArray:
        """Power of the noise in each bin."""
        return self.noise.spectrum(self.frequency, self.period)

    def band(self, low: float, high: float) -> tuple[float, float, float] | None:
        """Rms in SI, rms over that of the noise, and score of a band [Hz]; None without bins."""
        bins = (self.frequency >= low) & (self.frequency < high)
        count = int(np.count_nonzero(bins))
        if not count:
            return None
        ratio = float(np.mean(self.found[bins] / self.expected[bins]))
        rms = float(np.sqrt(np.sum(self.found[bins]) * 2.0 / len(self.residual)))
        degrees = max(2.0 * count * HANN * self.share, 1.0)
        return rms, float(np.sqrt(ratio)), score(ratio, degrees)

    def whiteness(self) -> tuple[float, float, float] | None:
        """Lag-one correlation above WHITE_FROM, that of the noise, and the spread between them.

        r_1 = sum P cos(w h) / sum P over the bins; where P is noise its spread is
        sqrt(sum (S (cos(w h) - r_1))^2) / sum S. None where the residual is quieter than half its
        noise: then it is counts, not noise, that are left.
        """
        bins = self.frequency >= WHITE_FROM
        found, expected = self.found[bins], self.expected[bins]
        if len(found) < 20 or np.sum(found) < 0.25 * np.sum(expected):
            return None
        cosine = np.cos(2.0 * np.pi * self.frequency[bins] * self.period)
        lag_one = float(found @ cosine / np.sum(found))
        asked = float(expected @ cosine / np.sum(expected))
        weight = expected * (cosine - asked)
        spread = np.sqrt(np.sum(weight**2) / (HANN * self.share)) / np.sum(expected)
        return lag_one, asked, float(spread)
