"""JointTask: one driven joint of a machine follows a motion; what a trial of it records."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import mujoco
import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.effects.place import Place
from ves_twin.envs.channels import Channel, Channels
from ves_twin.envs.joint_controller import JointController, Tuning, Wanted, effort_of
from ves_twin.machines.machine import Machine
from ves_twin.machines.mjcf.inputs.programmes import driven
from ves_twin.machines.mjcf.mjcf_machine import MjcfMachine
from ves_twin.machines.mjcf.motion.started import start_of
from ves_twin.machines.mjcf.motion.stepping import motion_of_drive
from ves_twin.machines.mjcf.motion.work import Work
from ves_twin.machines.mjcf.recordings.signals import rig_signals
from ves_twin.machines.mjcf.rig.description import Mode
from ves_twin.machines.mjcf.rig.machine import Rig

SECONDS = 4.0
"""Length of a trial [s]."""

HOLD = 5
"""Rows from one command to the next: 10 ms at rows of 2 ms."""

TONES = ((0.25, 0.5), (2.0 / 3.0, -0.25))
"""Of the motion: place in the machine's band, from 0 to 1 on its logarithm; size in typical
travels. Each tone is a (1 - cos w t), so that the motion begins at rest."""

BANDWIDTH = 1.3
"""Of the nominal feedback, in upper ends of the machine's band: 20 rad/s on the pendulum."""

DAMPED, FORGETS = 0.7, 0.1
"""Damping ratio of the nominal feedback; its integral's rate in bandwidths."""

LIMIT = 4.0
"""Of the command, in typical efforts."""

SLOW = 0.05
"""Speed over which the sign of dry friction is smoothed, in typical speeds."""

REACH, FAST = 4.0, 40.0
"""Of the readings, in typical travels and speeds: a pendulum may swing over."""

PARTS = (0.35, 0.6, 1.0, 1.7, 2.6)
"""Tones of a test, in middles of the machine's band."""

PHASES = (0.0, 2.1, 4.4, 0.9, 5.3)
"""Their phases [rad]: no two rise together."""


@dataclass(frozen=True)
class Trial:
    """What one trial gave.

    Attributes:
        rows: effort commanded, position and speed as read (n, 3).
        error: true position less the motion asked for (n,); no reading.
        saturated: share of the rows at the limit of the command.
    """

    rows: FloatArray
    error: FloatArray
    saturated: float

    @property
    def score(self) -> float:
        """Root mean square of the error, in thousandths of its unit."""
        return float(1e3 * np.sqrt(np.mean(self.error**2)))


@dataclass(frozen=True)
class JointTask:
    """A machine that is driven at one joint, whose position and speed are read.

    Attributes:
        rig: as believed.
    """

    rig: Rig

    @staticmethod
    def of(machine: Machine) -> JointTask:
        """The task on a machine.

        Raises:
            InvalidInputError: a machine with other drives or readings.
        """
        expected = "an MJCF machine in mode control, one drive, position and speed of its joint"
        if not isinstance(machine, MjcfMachine):
            raise InvalidInputError("plant", machine.name, expected)
        told = machine.rig.description
        one = told.drive.mode is Mode.CONTROL and len(driven(machine.rig)) == 1
        if not one or {c.of for c in told.compare.values() if c.joint} != {"position", "speed"}:
            raise InvalidInputError("plant", machine.name, expected)
        return JointTask(machine.rig)

    @cached_property
    def at(self) -> Place:
        """The driven joint with its typical sizes."""
        return driven(self.rig)[0][1]

    @cached_property
    def time(self) -> FloatArray:
        """Of the rows (n,) [s]."""
        period = self.rig.description.excitation.period or float(self.rig.model.opt.timestep)
        return np.asarray(period * np.arange(round(SECONDS / period)), float)

    @cached_property
    def signals(self) -> tuple[str, str, str]:
        """Names of command, position and speed."""
        found = {
            c.of: n for n, c in self.rig.description.compare.items() if c.joint == self.at.name
        }
        return driven(self.rig)[0][0], found["position"], found["speed"]

    @cached_property
    def noise(self) -> FloatArray:
        """Declared sd of the readings of position and speed (2,)."""
        channels = {c.signal: c.sd for c in MjcfMachine(self.rig).forward.channels}
        return np.array([channels[name] for name in self.signals[1:]])

    @cached_property
    def band(self) -> tuple[float, float]:
        """Lowest and highest frequency [Hz]."""
        natural = self.at.speed / (2.0 * np.pi * self.at.travel)
        low, high = self.rig.description.excitation.band or (natural, 10.0 * natural)
        return float(low), float(high)

    def tables(self, trials: int) -> tuple[Channels, Channels]:
        """Observations and actions, for so many trials."""
        rows, (effort, position, speed) = len(self.time), self.signals
        units = [self.rig.description.signals[name].unit for name in self.signals]
        limits = LIMIT * self.at.effort, REACH * self.at.travel, FAST * self.at.speed
        observed = [
            Channel.within(name, (unit,) * rows, limit, meaning)
            for name, unit, limit, meaning in zip(
                (effort, position, speed),
                units,
                limits,
                ("commanded in the last trial", "as read", "as read"),
                strict=True,
            )
        ]
        left = Channel(
            "trials.left", ("1",), np.zeros(1), np.array([float(trials)]), "the last one is scored"
        )
        e, x = units[0], units[1]
        tuned = (
            ("feedback.stiffness", "octave", 3.0, "of the nominal gain of the position"),
            ("feedback.damping", "octave", 3.0, "of the nominal gain of the speed"),
            ("feedback.integral", "octave", 3.0, "of the nominal gain of the integral"),
            ("feedforward.inertia", "1", 1.0, "added, share of the believed inertia"),
            ("feedforward.gravity", "1", 1.0, "added, share of the believed gravity"),
            ("feedforward.viscous", f"{e}*s/{x}", 0.2 * self.at.effort / self.at.speed, "added"),
            ("feedforward.dry", e, 0.6 * self.at.effort, "added, by the sign of the speed"),
            ("feedforward.spring", f"{e}/{x}", 1.5 * self.at.effort / self.at.travel, "added"),
            ("reading.offset", x, 0.15 * self.at.travel, "taken off the position"),
            ("feedforward.lead", "s", 0.05, "how far ahead it looks"),
            ("reading.late", "s", 0.05, "how old the readings are taken to be"),
            ("test.effort", e, self.at.effort, "five tones on top; none in the last trial"),
            ("test.pitch", "octave", 1.0, "of the middle of the machine's band"),
        )
        actions = Channels(*(Channel.within(n, (u,), limit, m) for n, u, limit, m in tuned))
        return Channels(*observed, left), actions

    @cached_property
    def nominal(self) -> Tuning:
        """Of the believed machine: inverse dynamics, and a feedback of BANDWIDTH."""
        model = self.rig.model
        dof = int(model.joint(self.at.name).dofadr[0])
        inertia = float(model.dof_M0[dof])
        rate = 2.0 * np.pi * BANDWIDTH * self.band[1]
        stiffness = inertia * rate**2
        return Tuning(
            stiffness=stiffness,
            damping=2.0 * DAMPED * inertia * rate,
            integral=FORGETS * rate * stiffness,
            inertia=inertia,
            gravity=1.0,
            viscous=float(model.dof_damping[dof]),
            dry=float(model.dof_frictionloss[dof]),
            spring=float(model.jnt_stiffness[model.joint(self.at.name).id]),
            offset=0.0,
            lead=0.0,
            late=0.0,
        )

    def tuning(self, values: Mapping[str, FloatArray]) -> Tuning:
        """The controller that an action's columns ask for."""
        a, n = {name: float(column[0]) for name, column in values.items()}, self.nominal
        return Tuning(
            stiffness=n.stiffness * 2.0 ** a["feedback.stiffness"],
            damping=n.damping * 2.0 ** a["feedback.damping"],
            integral=n.integral * 2.0 ** a["feedback.integral"],
            inertia=n.inertia * (1.0 + a["feedforward.inertia"]),
            gravity=n.gravity + a["feedforward.gravity"],
            viscous=n.viscous + a["feedforward.viscous"],
            dry=n.dry + a["feedforward.dry"],
            spring=n.spring + a["feedforward.spring"],
            offset=a["reading.offset"],
            lead=a["feedforward.lead"],
            late=a["reading.late"],
        )

    def wanted(self, shift: float = 0.0) -> Wanted:
        """The motion asked for at the rows, so many seconds later; at rest before it begins."""
        time = np.maximum(self.time + shift, 0.0)
        begun = self.time + shift >= 0.0
        low, high = self.band
        position, speed, pull = (np.zeros(len(time)) for _ in range(3))
        for place, size in TONES:
            w = 2.0 * np.pi * low * (high / low) ** place
            a = size * self.at.travel
            position += a * (1.0 - np.cos(w * time))
            speed += a * w * np.sin(w * time)
            pull += a * w**2 * np.cos(w * time) * begun
        return Wanted(position, speed, pull)

    def test(self, effort: float, pitch: float) -> FloatArray:
        """Efforts that are added for a test (n,): five tones that fade in and out."""
        low, high = self.band
        middle = np.sqrt(low * high) * 2.0**pitch
        tones = zip(PARTS, PHASES, strict=True)
        shape = sum(np.sin(2.0 * np.pi * p * middle * self.time + f) for p, f in tones)
        fade = np.sin(np.linspace(0.0, np.pi, len(self.time)))
        return np.asarray(effort / np.sqrt(len(PARTS)) * fade * shape)

    def run(
        self,
        tuning: Tuning,
        rng: np.random.Generator,
        test: FloatArray | None = None,
        rig: Rig | None = None,
        values: Mapping[str, float] | None = None,
        refined: bool = False,
    ) -> Trial:
        """A trial.

        Args:
            tuning: of the controller.
            rng: of the readings' noise.
            test: efforts that are added (n,).
            rig: the machine that runs; the believed one if None.
            values: what differs in it, by the names of its parameters.
            refined: with half the step.
        """
        rig = rig or self.rig
        effort, *read = self.signals
        none = {effort: np.zeros((len(self.time), 1))}
        rate = rig.description.rate
        work = Work.begin(rig, Excitation("trial", self.time, none, rate=rate), values or {})
        noise = self.noise * rng.standard_normal((len(self.time), 2))
        told = rig.description
        (actuator,) = told.drive.actuators
        ahead = self.wanted(tuning.lead)
        fed = effort_of(tuning, ahead, self._gravity(ahead.position), SLOW * self.at.speed)
        loop = JointController(
            actuator=work.model.actuator(actuator).id,
            work=work,
            joint=self.at.name,
            signals=(read[0], read[1]),
            signs=(told.compare[read[0]].sign, told.compare[read[1]].sign),
            noise=noise,
            tuning=tuning,
            ahead=fed if test is None else fed + test,
            behind=self.wanted(-tuning.late),
            hold=HOLD,
            limit=LIMIT * self.at.effort,
        )
        motion = motion_of_drive(work, Mode.CONTROL, refined, [loop])
        commands = motion.commands[:, loop.actuator]
        readings = [work.reading(name, motion.signals[name])[:, 0] for name in read]
        rows = np.stack([commands, *(r + n for r, n in zip(readings, noise.T, strict=True))], 1)
        at = int(work.model.joint(self.at.name).qposadr[0])
        error = motion.path[:, at] - self.wanted().position
        return Trial(rows, error, float(np.mean(np.abs(commands) >= loop.limit)))

    def recording(self, rows: FloatArray, name: str) -> Recording:
        """Rows (n, 3) of a trial as a diagnosis reads them: it begins at rest, and says so."""
        own = tuple(s for s in rig_signals(self.rig) if s.name in self.signals)
        columns = {n: rows[:, [k]].copy() for k, n in enumerate(self.signals)}
        start = start_of(self.rig, self.at.name)
        columns[start.name] = np.zeros((len(rows), 2))
        info = RecordingInfo(
            "measured", scenario=name, period=float(self.time[1]), own_signals=(*own, start)
        )
        return Recording(self.time, columns, info)

    def _gravity(self, position: FloatArray) -> FloatArray:
        """Believed effort that holds the joint at positions (n,), by a table."""
        places, efforts = self._held
        return np.interp(position, places, efforts)

    @cached_property
    def _held(self) -> tuple[FloatArray, FloatArray]:
        model = self.rig.model
        joint = model.joint(self.at.name)
        data, at, dof = mujoco.MjData(model), int(joint.qposadr[0]), int(joint.dofadr[0])
        reach = REACH * self.at.travel
        places = np.linspace(-reach, reach, 401)
        efforts = np.zeros_like(places)
        for k, place in enumerate(places):
            data.qpos[at] = place
            mujoco.mj_forward(model, data)
            efforts[k] = data.qfrc_bias[dof]
        return places, efforts
