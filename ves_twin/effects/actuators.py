"""Effects of an actuator: gain, delay."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import final

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.effects import change
from ves_twin.effects.change import Law, Loop
from ves_twin.effects.effect import Effect
from ves_twin.effects.element import Element
from ves_twin.effects.magnitude import Sign
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
        0.5,
        0.002,
        attribute=change.GAIN,
        source="assumed; magnets and amplifiers, per cents",
    )


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
class ActuatorDeadband(Effect):
    """Nothing acts until the command leaves a band: u -> sign(u) max(|u| - band, 0).

    Overlapped valves, amplifiers that hold back small currents. The command that an effort needs
    lies beyond the band on the side of the effort.
    """

    band: float = 0.0

    kind = "actuator_deadband"
    sizes = (Size("band", "", Sign.POSITIVE),)
    anywhere = Anywhere(Element.ACTUATOR, lambda p: 0.5 * p.effort)

    def edit_command(self, command: FloatArray, time: FloatArray) -> FloatArray:
        """What of it lies outside the band."""
        return np.asarray(np.sign(command) * np.maximum(np.abs(command) - self.band, 0.0))

    def edit_row(self, command: FloatArray, time: FloatArray, row: int) -> float:
        """That of one row."""
        return float(self.edit_command(command[row : row + 1], time)[0])

    def edit_required(self, effort: FloatArray, time: FloatArray) -> FloatArray:
        """Beyond the band."""
        return np.asarray(effort + self.band * np.sign(effort))
