"""Effects of the deployed leg and joint loops: what runs is not the program that is written.

One program runs all six legs, so its kinds have the target "legs"; a leg whose amplifier is off is
`valve_gain`. The sd is zero: commissioning leaves nothing open in a number of a program.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, final

from ves_twin.effects.effect import ALL_LEGS, JOINTS, Effect
from ves_twin.effects.magnitude import Magnitude, Sign

if TYPE_CHECKING:
    import numpy as np


@final
@dataclass(frozen=True)
class LegGain(Effect):
    """The leg loops run with another gain: K1 -> (1 + share) K1."""

    share: float = 0.0

    kind: ClassVar[str] = "leg_gain"
    targets: ClassVar[tuple[str, ...]] = ALL_LEGS
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (Magnitude("share", "1", 0.0, 0.02, 0.5),)
    channels: ClassVar[tuple[str, ...]] = ("leg.length", "valve.command")
    source: ClassVar[str] = "thesis 5.2: gains were tuned by hand at the rig"

    def edit_loop(self, parameters: np.void) -> None:
        """Scale the gain."""
        parameters["legs"]["gain"] *= 1.0 + self.share


@final
@dataclass(frozen=True)
class LegRateGain(Effect):
    """The leg loops damp more or less than they should: K2 -> K2 + change, on measured speed."""

    change: float = 0.0

    kind: ClassVar[str] = "leg_rate_gain"
    targets: ClassVar[tuple[str, ...]] = ALL_LEGS
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (Magnitude("change", "1", 0.0, 0.01, 0.2),)
    channels: ClassVar[tuple[str, ...]] = ("leg.length", "valve.command")
    source: ClassVar[str] = "thesis 5.2: K2 beside K1 in the deployed law"

    def edit_loop(self, parameters: np.void) -> None:
        """Add to the rate gain."""
        parameters["legs"]["rate_gain"] += self.change


@final
@dataclass(frozen=True)
class FilterEdge(Effect):
    """The leg filter's coefficients are those of another edge: f -> (1 + share) f.

    An edge without a filter is refused. The filter at another *place* is no size of anything: that
    is the scenario's `legs.filter`.
    """

    share: float = 0.0

    kind: ClassVar[str] = "filter_edge"
    targets: ClassVar[tuple[str, ...]] = ALL_LEGS
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (Magnitude("share", "1", 0.0, 0.05, 0.5),)
    channels: ClassVar[tuple[str, ...]] = ("leg.length", "valve.command")
    source: ClassVar[str] = "thesis Table 5-1, errata E-43: coefficients copied by hand"

    def edit_loop(self, parameters: np.void) -> None:
        """Move the edge; the coefficients follow from it."""
        parameters["legs"]["edge"] *= 1.0 + self.share


@final
@dataclass(frozen=True)
class CommandLimit(Effect):
    """The valve commands are cut off early: |u| <= 1 / (1 + tightness) in place of 1."""

    tightness: float = 0.0

    kind: ClassVar[str] = "command_limit"
    targets: ClassVar[tuple[str, ...]] = ALL_LEGS
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (
        Magnitude("tightness", "1", 0.0, 1.0, 9.0, Sign.POSITIVE),
    )
    channels: ClassVar[tuple[str, ...]] = ("leg.length", "valve.command")
    source: ClassVar[str] = "assumed; a limit left in the program, or a converter of less range"

    def edit_loop(self, parameters: np.void) -> None:
        """Lower the limit."""
        parameters["legs"]["limit"] /= 1.0 + self.tightness


@final
@dataclass(frozen=True)
class ServoGain(Effect):
    """A joint's servo runs with another stiffness: K -> (1 + share) K.

    The zero-g reference has the same servo: its arm is this arm, on the base that is meant.
    """

    share: float = 0.0

    kind: ClassVar[str] = "servo_gain"
    targets: ClassVar[tuple[str, ...]] = JOINTS
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (Magnitude("share", "1", 0.0, 0.02, 0.5),)
    channels: ClassVar[tuple[str, ...]] = ("arm.q", "arm.torque")
    source: ClassVar[str] = "thesis 2.4.3: gains set in the motion controller; size assumed"

    def edit_loop(self, parameters: np.void) -> None:
        """Scale the stiffness of the joint."""
        parameters["servo"]["stiffness"][self.index] *= 1.0 + self.share
