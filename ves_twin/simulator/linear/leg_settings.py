"""LegSettings: gains of the leg loop and the place of its section, also from counts."""

from __future__ import annotations

from dataclasses import dataclass

from ves_twin.control.leg_loop import FilterPlace

GAIN_PER_K1 = 1.05e-3
"""Leg gain per count of K1 [1/s]; assumed: one scale fits about 2 Hz at low gain and the 40 % of
5.5, so that neither counts in the score.

Source: errata E-48, E-49 (the thesis gives no unit).
"""

RATE_GAIN_PER_K2 = 0.1 / 30000
"""Rate gain per count of K2 [1]; assumed: 0.1 at 30000 keeps 5.6's "K2 hardly matters" open.

Source: errata E-49.
"""


@dataclass(frozen=True)
class LegSettings:
    """What an operator sets of the leg loops.

    Attributes:
        gain: leg speed per length error [1/s].
        rate_gain: leg speed command per measured speed [1].
        place: what the digital section filters.
    """

    gain: float
    rate_gain: float = 0.0
    place: FilterPlace = FilterPlace.NONE

    @staticmethod
    def of_counts(k1: float, k2: float, place: FilterPlace) -> LegSettings:
        """Settings of the thesis's counts K1 and K2 (thesis 5.6, at most 30000)."""
        return LegSettings(GAIN_PER_K1 * k1, RATE_GAIN_PER_K2 * k2, place)
