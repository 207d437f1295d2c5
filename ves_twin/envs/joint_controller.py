"""JointController: PID with feedforward for one joint, on what a machine's sensors read."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import final

import mujoco
import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.machines.mjcf.motion.work import Work


@dataclass(frozen=True)
class Tuning:
    """What is tuned; the believed machine's numbers make the nominal one.

    Attributes:
        stiffness, damping, integral: gains of the feedback, per reading in SI.
        inertia: effort per acceleration.
        gravity: factor of the believed effort of gravity.
        viscous, dry, spring: effort per speed, by its sign, per position.
        offset: taken off the reading of the position.
        lead: how far ahead the feedforward looks [s].
        late: how old the readings are taken to be [s].
    """

    stiffness: float
    damping: float
    integral: float
    inertia: float
    gravity: float
    viscous: float
    dry: float
    spring: float
    offset: float
    lead: float
    late: float


@dataclass(frozen=True)
class Wanted:
    """The motion that is asked for at the rows, by times: position, speed, acceleration (n,)."""

    position: FloatArray
    speed: FloatArray
    acceleration: FloatArray


@final
@dataclass
class JointController:
    """u = k e + d e' + i int(e) dt + J r'' + b r' + c tanh(r'/slow) + g(r) + s r, held, limited.

    e = r(t - late) - (y - offset) with the readings y and y'; the feedforward takes r at t + lead.

    Attributes:
        actuator: number in the model.
        work: the machine that runs, whose sensors are read.
        signals: names of position and speed.
        places: qpos and dof of the joint.
        signs: with which the signals count.
        noise: of both readings at the rows (n, 2).
        tuning: in force.
        ahead: believed effort of the motion, with what is added for a test (n,).
        behind: motion that the readings are held against.
        hold: rows from one command to the next.
        limit: of the command.
    """

    actuator: int
    work: Work
    joint: str
    signals: tuple[str, str]
    signs: tuple[int, int]
    noise: FloatArray
    tuning: Tuning
    ahead: FloatArray
    behind: Wanted
    hold: int
    limit: float
    _sum: float = 0.0
    _last: float = 0.0
    _true: FloatArray = field(init=False)

    def __post_init__(self) -> None:
        joint = self.work.model.joint(self.joint)
        self._at, self._dof = int(joint.qposadr[0]), int(joint.dofadr[0])
        self._true = np.zeros((2, len(self.ahead), 1))

    def command(self, row: int, data: mujoco.MjData) -> float:
        """The effort from a row on; between two of its cycles the last one."""
        self._true[0, row:] = self.signs[0] * data.qpos[self._at]
        self._true[1, row:] = self.signs[1] * data.qvel[self._dof]
        if row % self.hold:
            return self._last
        told, period = self.tuning, self.hold * self.work.programme.period
        position, speed = (
            sign * (self.work.reading(name, true)[row, 0] + noise)
            for name, true, noise, sign in zip(
                self.signals, self._true, self.noise[row], self.signs, strict=True
            )
        )
        error = float(self.behind.position[row] - position + told.offset)
        rate = float(self.behind.speed[row] - speed)
        effort = told.stiffness * error + told.damping * rate + told.integral * self._sum
        effort += float(self.ahead[row])
        self._last = min(max(effort, -self.limit), self.limit)
        if self._last == effort:  # no wind-up
            self._sum += error * period
        return self._last


def effort_of(tuning: Tuning, wanted: Wanted, gravity: FloatArray, slow: float) -> FloatArray:
    """Feedforward along a motion (n,).

    Args:
        tuning: coefficients.
        wanted: the motion, `lead` ahead.
        gravity: believed effort along it (n,).
        slow: speed over which the sign of dry friction is smoothed.
    """
    return np.asarray(
        tuning.inertia * wanted.acceleration
        + tuning.gravity * gravity
        + tuning.viscous * wanted.speed
        + tuning.dry * np.tanh(wanted.speed / slow)
        + tuning.spring * wanted.position
    )
