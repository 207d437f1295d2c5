"""MapPoint: stability of the admittance loop at one leg gain and filter place."""

from __future__ import annotations

from dataclasses import dataclass

from ves_twin.procedures.stability.confirm import Confirmation


@dataclass(frozen=True)
class MapPoint:
    """Stability at one gain and filter place.

    Attributes:
        gain: of the leg loops [1/s].
        place: what the leg filter filters.
        payload: mass above the force sensor [kg].
        limit: lowest stable mass [kg]: the range's end if all of it is stable or none is.
        bounded: whether the limit lies within the range.
        frequency: of the oscillation at the limit [Hz].
        one_axis: limit of the one-axis model [kg].
        base_growth: growth rate with the scenario's own base [1/s].
        base_frequency: frequency of that oscillation [Hz].
        runs: growth measured in runs beside the limit.
    """

    gain: float
    place: str
    payload: float
    limit: float
    bounded: bool
    frequency: float
    one_axis: float
    base_growth: float
    base_frequency: float
    runs: tuple[Confirmation, ...] = ()

    @property
    def share(self) -> float:
        """Limit over payload."""
        return self.limit / self.payload
