"""Effects of an actuator: gain, delay, and the curve from its command to what it gives."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import final

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.effects import change
from ves_twin.effects.change import Law, Loop
from ves_twin.effects.curve import Curve
from ves_twin.effects.effect import Effect
from ves_twin.effects.element import Element
from ves_twin.effects.magnitude import Magnitude, Sign
from ves_twin.effects.place import Place
from ves_twin.effects.row import ALL_LEGS, JOINTS, Anywhere, Part, Row
from ves_twin.effects.shifted import shifted
from ves_twin.effects.size import Size


@final
@dataclass(frozen=True)
class ActuatorGain(Effect):
    """An actuator gives another effort than its command, or its recorded current, says.

    On VES II T -> (1 + gain) T at a joint; elsewhere MuJoCo's gain g -> g + gain.
    """

    gain: float = 0.0

    kind = "actuator_gain"
    sizes = (Size("gain", "1"),)
    source = "assumed; magnets and amplifiers, a per cent"
    rows = (
        Row(
            JOINTS,
            (0.01, 0.02, 0.3),
            ("arm.torque",),
            Loop("drive.torque_gain", Law.SCALE),
            Part.ARM,
        ),
    )
    anywhere = Anywhere(
        Element.ACTUATOR,
        lambda p: 0.5 * max(abs(p.gain), 1.0),
        lambda p: 0.002 * max(abs(p.gain), 1.0),
        attribute=change.GAIN,
        source="assumed; magnets and amplifiers, per cents",
    )

    @classmethod
    def magnitudes_at(cls, place: Place) -> tuple[Magnitude, ...]:
        """The gain with its range; raises InvalidInputError of a servo, whose kp is another kind.

        A gain of the set-point alone would make another actuator of it than a servo.
        """
        if place.stiffness:
            expected = "a drive whose command is no place; of a servo name servo_stiffness"
            raise InvalidInputError(f"target of {cls.kind}", place.name, expected)
        return super().magnitudes_at(place)


@final
@dataclass(frozen=True)
class ActuatorDelay(Effect):
    """A command acts later than it is recorded: u(t) -> u(t - delay).

    On VES II the currents of all six valves, or the arm's set-points. Between two ticks a late
    signal is a straight line, so that it is continuous in its size. The sd is zero there: the
    clocks are digital, and what analog parts leave open is `valve_lag`.
    """

    delay: float = 0.0

    kind = "actuator_delay"
    sizes = (Size("delay", "s", Sign.POSITIVE),)
    proportional = False
    rows = (
        Row(
            ALL_LEGS,
            (0.0, 5e-4, 0.02),
            ("leg.length", "valve.command"),
            Loop("late.current.delay"),
            Part.CLOCK,
            source="thesis 2.4.2 (leg computer at 587 Hz); one of its cycles is 1.7 ms",
        ),
        Row(
            ("arm",),
            (0.0, 5e-4, 0.02),
            ("arm.q", "arm.torque", "sensor.wrench"),
            Loop("late.setpoint.delay"),
            Part.DRIVE,
            source="thesis 2.4.3 (a computer of its own drives the arm); size assumed",
        ),
    )
    # 50 ms: assumed, a slow fieldbus and its filters
    anywhere = Anywhere(Element.ACTUATOR, 0.05, 1e-4)

    def edit_command(self, command: FloatArray, time: FloatArray) -> FloatArray:
        """That of a delay ago."""
        return shifted(command, time, self.delay)

    def edit_row(self, command: FloatArray, time: FloatArray, row: int) -> float:
        """That of a delay ago, between the two rows about it."""
        late = row - self.delay * (len(time) - 1) / float(time[-1] - time[0])
        below = math.floor(late)
        share = late - below
        ends = command[max(below, 0)], command[min(max(below + 1, 0), row)]
        return float((1.0 - share) * ends[0] + share * ends[1])

    def edit_required(self, effort: FloatArray, time: FloatArray) -> FloatArray:
        """That of a delay ahead."""
        return shifted(effort, time, -self.delay)


@final
@dataclass(frozen=True)
class ActuatorOffset(Curve):
    """A command acts as if it was another by a constant: u -> u + offset.

    A valve whose neutral is off. Beside a dead band it makes the two sides differ.
    """

    offset: float = 0.0

    kind = "actuator_offset"
    sizes = (Size("offset", ""),)
    anywhere = Anywhere(Element.ACTUATOR, lambda p: 0.5 * p.effort)

    def edit_command(self, command: FloatArray, time: FloatArray) -> FloatArray:
        """With the offset."""
        return np.asarray(command + self.offset)

    def edit_required(self, effort: FloatArray, time: FloatArray) -> FloatArray:
        """Without it."""
        return np.asarray(effort - self.offset)


@final
@dataclass(frozen=True)
class ActuatorDeadband(Curve):
    """Nothing acts until the command leaves a band: u -> sign(u) max(|u| - band, 0).

    Overlapped valves, amplifiers that hold back small currents. The command that an effort needs
    lies beyond the band on the side of the effort.
    """

    band: float = 0.0

    kind = "actuator_deadband"
    sizes = (Size("band", "", Sign.POSITIVE),)
    anywhere = Anywhere(Element.ACTUATOR, lambda p: 0.5 * p.effort)

    @classmethod
    def magnitudes_at(cls, place: Place) -> tuple[Magnitude, ...]:
        """The band with its range; raises InvalidInputError of a servo, told a place and no effort.

        A servo's own dead band lies about where it is told to be.
        """
        if place.stiffness:
            expected = "a drive whose command is an effort, or a rate"
            raise InvalidInputError(f"target of {cls.kind}", place.name, expected)
        return super().magnitudes_at(place)

    def edit_command(self, command: FloatArray, time: FloatArray) -> FloatArray:
        """What of it lies outside the band."""
        return np.asarray(np.sign(command) * np.maximum(np.abs(command) - self.band, 0.0))

    def edit_required(self, effort: FloatArray, time: FloatArray) -> FloatArray:
        """Beyond the band."""
        return np.asarray(effort + self.band * np.sign(effort))


LEAST_SLOPE = 0.01
"""Of a saturated actuator where a command is asked for: none gives more than it can, and the
command for more must be finite."""


@final
@dataclass(frozen=True)
class ActuatorSaturation(Curve):
    """Beyond a limit a command gives less: of what is beyond, a share is lost; all of it at 1.

    A valve that is open, a pump or an amplifier at its end.
    """

    share: float = 0.0
    limit: float = 0.0

    kind = "actuator_saturation"
    sizes = (Size("share", "1", Sign.POSITIVE), Size("limit", "", Sign.POSITIVE))
    anywhere = Anywhere(Element.ACTUATOR)

    @classmethod
    def magnitudes_at(cls, place: Place) -> tuple[Magnitude, ...]:
        """All of it lost, up to twice the typical command."""
        return cls.ranged(place, 1.0, 2.0 * place.effort)

    @classmethod
    def starts(cls, place: Place) -> tuple[tuple[float, ...], ...]:
        """All lost beyond an eighth to all of the typical command."""
        return tuple((1.0, limit * place.effort) for limit in (0.125, 0.25, 0.5, 0.7, 1.0))

    def edit_command(self, command: FloatArray, time: FloatArray) -> FloatArray:
        """What is left of it."""
        within = np.clip(command, -self.limit, self.limit)
        return np.asarray(command - self.share * (command - within))

    def edit_required(self, effort: FloatArray, time: FloatArray) -> FloatArray:
        """Further out beyond the limit."""
        within = np.clip(effort, -self.limit, self.limit)
        return np.asarray(within + (effort - within) / max(1.0 - self.share, LEAST_SLOPE))


@final
@dataclass(frozen=True)
class ActuatorAsymmetry(Curve):
    """An actuator gives more one way than the other: u -> u (1 + share sign(u)).

    A cylinder with a rod on one side, behind its valve, moves faster where the oil enters there:
    areas A and B make a share of (B - A) / (A + B).
    """

    share: float = 0.0

    kind = "actuator_asymmetry"
    sizes = (Size("share", "1"),)
    # a rod of 0.7 of the bore halves the area, a share of a third
    anywhere = Anywhere(Element.ACTUATOR, 0.5, 0.002, source="assumed: rods up to 0.8 of the bore")

    def edit_command(self, command: FloatArray, time: FloatArray) -> FloatArray:
        """Each side with its own gain."""
        return np.asarray(command + self.share * np.abs(command))

    def edit_required(self, effort: FloatArray, time: FloatArray) -> FloatArray:
        """Each side without it."""
        return np.asarray(effort / (1.0 + self.share * np.sign(effort)))


FROM = " from "
"""Between a drive and the one whose command it picks up."""


@final
@dataclass(frozen=True)
class DriveCrossTalk(Effect):
    """A drive picks up a share of the command to another one: u_i -> u_i + share u_j.

    Currents that couple between cables and amplifiers, a wrist in which one motor turns two axes.
    Target "motor_5 from motor_6" is motor 5 picking up that of motor 6, behind its own dead band,
    curve and delay; commands in the units of each.
    """

    share: float = 0.0

    kind = "drive_cross_talk"
    sizes = (Size("share", "1"),)
    anywhere = Anywhere(Element.ACTUATOR, 0.3, 0.001, source="assumed: up to a third")

    @property
    def parts(self) -> tuple[str, ...]:
        """The drive, and the one whose command it picks up.

        Raises:
            InvalidInputError: a target that does not say two.
        """
        found = tuple(self.target.split(FROM))
        if len(set(found)) != 2:
            expected = "two drives, as motor_5 from motor_6"
            raise InvalidInputError(f"target of {self.kind}", self.target, expected)
        return found

    def pick_up(self, commands: Mapping[str, FloatArray]) -> FloatArray | float:
        """A share of the other one's."""
        _, other = self.parts
        return self.share * commands[other] if other in commands else 0.0
