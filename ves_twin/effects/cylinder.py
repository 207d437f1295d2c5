"""Effects of the cylinders: dry and viscous friction, leakage, air in the oil."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, final

from ves_twin.core.types import FloatArray
from ves_twin.effects.effect import LEGS, Effect
from ves_twin.effects.magnitude import Magnitude, Sign


@final
@dataclass(frozen=True)
class CoulombFriction(Effect):
    """Dry friction of a piston: it sticks below `level` and slides against it above."""

    level: float = 0.0

    kind: ClassVar[str] = "coulomb_friction"
    targets: ClassVar[tuple[str, ...]] = LEGS
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (
        Magnitude("level", "N", 0.0, 5.0, 400.0, Sign.POSITIVE),
    )
    channels: ClassVar[tuple[str, ...]] = ("leg.length", "sensor.wrench")
    source: ClassVar[str] = "assumed; 1 to 3 % of the 12 kN that a leg can give"

    def edit_numbers(self, numbers: dict[str, FloatArray]) -> None:
        """Add to the dry friction of the leg."""
        numbers["leg.dry_friction"][self.index] += self.level


@final
@dataclass(frozen=True)
class CylinderViscous(Effect):
    """A piston drags more in proportion to its speed: seals, cold oil."""

    damping: float = 0.0

    kind: ClassVar[str] = "cylinder_viscous"
    targets: ClassVar[tuple[str, ...]] = LEGS
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (
        Magnitude("damping", "N*s/m", 50.0, 100.0, 2e4, Sign.POSITIVE),
    )
    channels: ClassVar[tuple[str, ...]] = ("leg.length",)
    source: ClassVar[str] = "assumed; seals"

    def edit_numbers(self, numbers: dict[str, FloatArray]) -> None:
        """Add to the viscous friction of the leg."""
        numbers["chamber.viscous"][self.index] += self.damping


@final
@dataclass(frozen=True)
class PistonLeakage(Effect):
    """Oil passes the piston seal: the leg sags under load by more."""

    leakage: float = 0.0

    kind: ClassVar[str] = "piston_leakage"
    targets: ClassVar[tuple[str, ...]] = LEGS
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (
        Magnitude("leakage", "m^3/s/Pa", 1e-13, 2e-13, 5e-11, Sign.POSITIVE),
    )
    channels: ClassVar[tuple[str, ...]] = ("leg.length", "valve.command")
    source: ClassVar[str] = "Merritt 1967, chapter 6; a worn seal"

    def edit_numbers(self, numbers: dict[str, FloatArray]) -> None:
        """Add to the leakage of the leg."""
        numbers["chamber.leakage"][self.index] += self.leakage


@final
@dataclass(frozen=True)
class OilAir(Effect):
    """Air in the oil of a leg: its bulk modulus falls to (1 - loss) of nominal."""

    loss: float = 0.0

    kind: ClassVar[str] = "oil_air"
    targets: ClassVar[tuple[str, ...]] = LEGS
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (
        Magnitude("loss", "1", 0.02, 0.04, 0.8, Sign.POSITIVE),
    )
    channels: ClassVar[tuple[str, ...]] = ("leg.length", "sensor.wrench")
    source: ClassVar[str] = "Merritt 1967, section 2.2: one per cent of air halves the modulus"

    def edit_numbers(self, numbers: dict[str, FloatArray]) -> None:
        """Lower the bulk modulus of the leg."""
        numbers["chamber.bulk_modulus"][self.index] *= 1.0 - self.loss
