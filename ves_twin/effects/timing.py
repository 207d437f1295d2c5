"""Effects of timing: a delay at the transducers, the valves, the force sensor or the arm's drives.

Each is continuous in its size: between two ticks a late signal is a straight line. The sd is zero,
since the clocks are digital: what analog parts leave open is `valve_lag` and `sensor_lag`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, final

from ves_twin.effects.effect import ALL_LEGS, LEGS, Effect
from ves_twin.effects.magnitude import Magnitude, Sign

if TYPE_CHECKING:
    import numpy as np

_LATE = Magnitude("delay", "s", 0.0, 5e-4, 0.02, Sign.POSITIVE)


@final
@dataclass(frozen=True)
class TransducerDelay(Effect):
    """A transducer reads where its rod was: L(t) -> L(t - delay).

    The leg loop feels it as it feels `valve_delay` on that leg, so that lengths alone part the two
    only by the legs that take part.
    """

    delay: float = 0.0

    kind: ClassVar[str] = "transducer_delay"
    targets: ClassVar[tuple[str, ...]] = LEGS
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (_LATE,)
    channels: ClassVar[tuple[str, ...]] = ("leg.length", "valve.command")
    source: ClassVar[str] = "thesis 2.4.1 and errata E-5: the cards' update time was printed wrong"

    def edit_loop(self, parameters: np.void) -> None:
        """Delay the travel that the transducer sees."""
        parameters["late"]["slide"]["delay"][self.index] += self.delay


@final
@dataclass(frozen=True)
class ValveDelay(Effect):
    """The valves get their currents late: the leg computer sends when its cycle has ended."""

    delay: float = 0.0

    kind: ClassVar[str] = "valve_delay"
    targets: ClassVar[tuple[str, ...]] = ALL_LEGS
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (_LATE,)
    channels: ClassVar[tuple[str, ...]] = ("leg.length", "valve.command")
    source: ClassVar[str] = "thesis 2.4.2 (leg computer at 587 Hz); one of its cycles is 1.7 ms"

    def edit_loop(self, parameters: np.void) -> None:
        """Delay the currents of all six valves."""
        parameters["late"]["current"]["delay"] += self.delay


@final
@dataclass(frozen=True)
class SensorDelay(Effect):
    """The wrench is read late, beyond the lag of the low-pass: W(t) -> W(t - delay)."""

    delay: float = 0.0

    kind: ClassVar[str] = "sensor_delay"
    targets: ClassVar[tuple[str, ...]] = ("sensor",)
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (_LATE,)
    channels: ClassVar[tuple[str, ...]] = ("sensor.wrench",)
    source: ClassVar[str] = "assumed; conversion and transfer by the sensor's own electronics"

    def edit_loop(self, parameters: np.void) -> None:
        """Delay the wrench that the electronics get."""
        parameters["late"]["wrench"]["delay"] += self.delay


@final
@dataclass(frozen=True)
class DriveDelay(Effect):
    """The joint servos get their set-points late: the arm follows the recorded command later."""

    delay: float = 0.0

    kind: ClassVar[str] = "drive_delay"
    targets: ClassVar[tuple[str, ...]] = ("arm",)
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (_LATE,)
    channels: ClassVar[tuple[str, ...]] = ("arm.q", "arm.torque", "sensor.wrench")
    source: ClassVar[str] = "thesis 2.4.3 (a computer of its own drives the arm); size assumed"

    def edit_loop(self, parameters: np.void) -> None:
        """Delay angle and rate set-points of all joints."""
        parameters["late"]["setpoint"]["delay"] += self.delay
