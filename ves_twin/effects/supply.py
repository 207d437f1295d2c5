"""Effects of the oil supply: pressure off nominal, droop under flow."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, final

from ves_twin.core.types import FloatArray
from ves_twin.effects.effect import RIG, Effect
from ves_twin.effects.magnitude import Magnitude, Sign


@final
@dataclass(frozen=True)
class SupplyPressure(Effect):
    """The pump is set off its nominal pressure, for all legs alike."""

    pressure: float = 0.0

    kind: ClassVar[str] = "supply_pressure"
    targets: ClassVar[tuple[str, ...]] = RIG
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (Magnitude("pressure", "Pa", 1e5, 1e5, 3e6),)
    channels: ClassVar[tuple[str, ...]] = ("supply.pressure", "leg.length")
    source: ClassVar[str] = "assumed; a relief valve is set within a per cent"

    def edit_numbers(self, numbers: dict[str, FloatArray]) -> None:
        """Shift the pressure of the source."""
        numbers["supply.pressure"] += self.pressure


@final
@dataclass(frozen=True)
class SupplyDroop(Effect):
    """The manifold loses pressure in proportion to what the legs draw: P0 - P = droop Q."""

    droop: float = 0.0

    kind: ClassVar[str] = "supply_droop"
    targets: ClassVar[tuple[str, ...]] = RIG
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (
        Magnitude("droop", "Pa*s/m^3", 0.0, 2e7, 4e9, Sign.POSITIVE),
    )
    channels: ClassVar[tuple[str, ...]] = ("supply.pressure", "leg.length")
    source: ClassVar[str] = "assumed; a tired pump or a clogged filter, 0.2 to 40 bar at 1 l/s"

    def edit_numbers(self, numbers: dict[str, FloatArray]) -> None:
        """Add to the droop of the manifold."""
        numbers["supply.droop"] += self.droop
