"""Effects of the servovalves: null offset, gain, overlap, lag."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, final

from ves_twin.core.types import FloatArray
from ves_twin.effects.effect import LEGS, Effect
from ves_twin.effects.magnitude import Magnitude, Sign


@final
@dataclass(frozen=True)
class ValveNull(Effect):
    """A spool is open by a share of full opening when its current is zero.

    The leg loop has no integrator, so that the leg stands off by null * full_speed / gain.
    """

    null: float = 0.0

    kind: ClassVar[str] = "valve_null"
    targets: ClassVar[tuple[str, ...]] = LEGS
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (Magnitude("null", "1", 0.0005, 0.001, 0.05),)
    channels: ClassVar[tuple[str, ...]] = ("leg.length", "valve.command")
    source: ClassVar[str] = "servovalve catalogues: null shifts of some tenths of a per cent to 2 %"

    def edit_numbers(self, numbers: dict[str, FloatArray]) -> None:
        """Shift the null of the leg's valve."""
        numbers["hydraulics.valve_null"][self.index] += self.null


@final
@dataclass(frozen=True)
class ValveGain(Effect):
    """A valve lets through more flow than its rating: flow (1 + gain) times nominal."""

    gain: float = 0.0

    kind: ClassVar[str] = "valve_gain"
    targets: ClassVar[tuple[str, ...]] = LEGS
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (Magnitude("gain", "1", 0.01, 0.02, 0.5),)
    channels: ClassVar[tuple[str, ...]] = ("leg.length", "valve.command")
    source: ClassVar[str] = "rated flows are given within 10 %; a per cent after commissioning"

    def edit_numbers(self, numbers: dict[str, FloatArray]) -> None:
        """Scale the gain of the leg's valve."""
        numbers["hydraulics.valve_gain"][self.index] *= 1.0 + self.gain


@final
@dataclass(frozen=True)
class ValveDeadband(Effect):
    """The lands overlap the ports: nothing flows within +-deadband of the null."""

    deadband: float = 0.0

    kind: ClassVar[str] = "valve_deadband"
    targets: ClassVar[tuple[str, ...]] = LEGS
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (
        Magnitude("deadband", "1", 0.0, 0.0005, 0.05, Sign.POSITIVE),
    )
    channels: ClassVar[tuple[str, ...]] = ("leg.length", "valve.command")
    source: ClassVar[str] = "Merritt 1967, chapter 5; an axis-cut spool has under 1 %"

    def edit_numbers(self, numbers: dict[str, FloatArray]) -> None:
        """Add to the overlap of the leg's valve."""
        numbers["hydraulics.valve_deadband"][self.index] += self.deadband


@final
@dataclass(frozen=True)
class ValveLag(Effect):
    """A spool answers more slowly: its time constant is longer by `lag`."""

    lag: float = 0.0

    kind: ClassVar[str] = "valve_lag"
    targets: ClassVar[tuple[str, ...]] = LEGS
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (
        Magnitude("lag", "s", 2e-4, 4e-4, 0.02, Sign.POSITIVE),
    )
    channels: ClassVar[tuple[str, ...]] = ("leg.length", "valve.command")
    source: ClassVar[str] = "assumed; dirt and worn pilots slow a spool by milliseconds"

    def edit_numbers(self, numbers: dict[str, FloatArray]) -> None:
        """Lengthen the time constant of the leg's spool."""
        numbers["hydraulics.valve_lag"][self.index] += self.lag
