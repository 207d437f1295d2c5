"""Pendulum: one link on a hinge, in MuJoCo, as a plant for the diagnosis."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, replace

import mujoco
import numpy as np
from mujoco import rollout

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.signals import Role, Signal
from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.model.forward import Channel, Excitation, Hypothesis, Parameter

STEP = 0.002
"""Integration step [s]; rows of a recording are a whole number of steps apart."""

NEAR = 1e-3
"""Relative error of a period that is round-off of recorded times."""

_XML = """
<mujoco>
  <option timestep="0.002" integrator="implicitfast"><flag contact="disable"/></option>
  <worldbody>
    <body name="link">
      <joint name="hinge" type="hinge" axis="0 1 0" damping="0.05" armature="0.01"
             solreffriction="0.004 1" solimpfriction="0.9999 0.9999 0.001 0.5 2"/>
      <geom name="rod" type="capsule" fromto="0 0 0 0 0 -0.4" size="0.03" mass="1"/>
    </body>
  </worldbody>
  <actuator><motor name="torque" joint="hinge"/></actuator>
</mujoco>
"""

_SOURCE = "the pendulum of the peers' table: sizes a tenth to three times of its rows"

CHANNELS = (
    Channel("joint.angle", "joint.angle", 0, "rad", 0.001),
    Channel("joint.rate", "joint.rate", 0, "rad/s", 0.01),
)
"""Encoder and rate sensor, white noise of 1 mrad and 10 mrad/s per sample."""

PARAMETERS = (
    Parameter("joint.damping", "N*m*s/rad", 0.05, 0.0, 2.0, sd=0.001),
    Parameter("joint.friction", "N*m", 0.0, 0.0, 1.0),
    Parameter("joint.stiffness", "N*m/rad", 0.0, 0.0, 3.0),
    Parameter("joint.armature", "kg*m^2", 0.01, 0.001, 0.2, sd=0.0001),
    Parameter("link.mass", "kg", 1.0, 0.3, 3.0, sd=0.005),
    Parameter("drive.gain", "1", 1.0, 0.5, 1.5, sd=0.005),
    Parameter("sensor.delay", "s", 0.0, -0.005, 0.05, sd=0.0002),
    Parameter("encoder.bias", "rad", 0.0, -0.3, 0.3, sd=0.001),
    Parameter("start.angle", "rad", 0.0, -0.1, 0.1, sd=0.001, per_recording=True),
    Parameter("start.rate", "rad/s", 0.0, -0.5, 0.5, sd=0.005, per_recording=True),
    Parameter("drive.offset", "N*m", 0.0, -0.1, 0.1, sd=0.002, per_recording=True),
)
"""What may differ. Friction and stiffness are absent by declaration; the rest is known to its sd
(assumed: what scales, a stop watch and a datasheet give)."""


def _hypothesis(
    effect: str, target: str, parameter: str, smallest: float, largest: float, one: bool = False
) -> Hypothesis:
    signs = (1,) if one else (-1, 1)
    return Hypothesis(effect, target, (parameter,), (smallest,), (largest,), signs, _SOURCE)


HYPOTHESES = (
    _hypothesis("viscous_damping", "joint", "joint.damping", 0.002, 0.05),
    _hypothesis("coulomb_friction", "joint", "joint.friction", 0.0005, 0.5, one=True),
    _hypothesis("joint_stiffness", "joint", "joint.stiffness", 0.002, 1.2, one=True),
    _hypothesis("rotor_inertia", "joint", "joint.armature", 0.0002, 0.01),
    _hypothesis("link_mass", "link", "link.mass", 0.01, 0.3),
    _hypothesis("torque_gain", "drive", "drive.gain", 0.01, 0.3),
    _hypothesis("delay", "sensor", "sensor.delay", 0.0004, 0.03, one=True),
    _hypothesis("encoder_offset", "sensor", "encoder.bias", 0.002, 0.1),
)
"""The library."""

COMMAND_DELAY = (
    Parameter("command.delay", "s", 0.0, -0.005, 0.05, sd=0.0002),
    _hypothesis("delay", "command", "command.delay", 0.0004, 0.03, one=True),
)
"""A twin of the sensor delay: from rest, in open loop, no recording tells them apart."""


START = Signal(
    "joint.start",
    ("angle", "rate"),
    ("rad", "rad/s"),
    Role.COMMAND,
    "joint",
    "where the motion begins",
)
"""Fed in where a recording does not begin at rest; the same in all rows."""

UNKNOWN_START = {"start.angle": 0.03, "start.rate": 0.3}
"""Sd about a start that was read off a recording [rad], [rad/s]: a tenth of a swing, so that what
a delay or a bias moves it by is free."""

BEFORE = 0.05
"""Rows of a cut recording this early [s] may show what a delay held back from before the cut."""


@dataclass(frozen=True)
class Pendulum:
    """The plant: edits of its MjSpec (mass, damping, friction, spring, armature) and its loop.

    Loop edits: the torque is gain * u(t - delay) + offset; both sensors read a delay ago; the
    encoder has a bias. Steps are MuJoCo's, at 2 ms.

    Attributes:
        parameters: what may differ.
        hypotheses: the library.
        channels: what is compared.
        started: whether recordings say where they begin; at rest if not.
    """

    parameters: tuple[Parameter, ...] = PARAMETERS
    hypotheses: tuple[Hypothesis, ...] = HYPOTHESES
    channels: tuple[Channel, ...] = CHANNELS
    started: bool = False

    @staticmethod
    def with_command_delay() -> Pendulum:
        """With the delay of the command in the library too."""
        parameter, hypothesis = COMMAND_DELAY
        return Pendulum((*PARAMETERS, parameter), (*HYPOTHESES, hypothesis))

    def anywhere(self, known: bool) -> Pendulum:
        """For recordings that say where they begin; read off their first rows if not `known`."""
        if known:
            return replace(self, started=True)
        widened = tuple(
            replace(p, sd=UNKNOWN_START[p.name], low=-10.0 * sd, high=10.0 * sd)
            if (sd := UNKNOWN_START.get(p.name, 0.0))
            else p
            for p in self.parameters
        )
        later = tuple(replace(c, settling=BEFORE) for c in self.channels)
        return replace(self, started=True, parameters=widened, channels=later)

    @property
    def identity(self) -> str:
        """Hash of model, library and MuJoCo's version."""
        parts = (_XML, self.parameters, self.hypotheses, self.channels, mujoco.__version__)
        return hashlib.sha256(repr(parts).encode()).hexdigest()[:16]

    @property
    def drive(self) -> tuple[str, ...]:
        """The torque that was asked for [N m], and where the motion began."""
        return ("joint.torque", START.name) if self.started else ("joint.torque",)

    def simulate(
        self, programme: Excitation, values: Mapping[str, float], refined: bool = False
    ) -> FloatArray:
        """Angle [rad] and rate [rad/s] at each row, whose torque holds from then on (n, 2).

        Raises:
            InvalidInputError: rows that are no whole number of steps apart.
        """
        period = programme.period
        per_row = round(period / STEP)
        if per_row < 1 or abs(period / (per_row * STEP) - 1.0) > NEAR:
            raise InvalidInputError(
                "time between rows [s]", round(period, 6), f"a whole multiple of {STEP} s"
            )
        value = {p.name: p.nominal for p in self.parameters} | dict(values)
        asked = programme.drive["joint.torque"][:, 0]
        torque = value["drive.gain"] * _delayed(asked, value.get("command.delay", 0.0), period)
        torque = torque + value["drive.offset"]
        model = edited(value)
        steps = per_row * (2 if refined else 1)
        model.opt.timestep = per_row * STEP / steps
        state = np.zeros(mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS))
        begun = programme.drive[START.name][0] if START.name in programme.drive else (0.0, 0.0)
        state[1], state[2] = value["start.angle"] + begun[0], value["start.rate"] + begun[1]
        control = np.repeat(torque, steps)[None, :, None]
        path, _ = rollout.rollout(
            model, mujoco.MjData(model), initial_state=state[None], control=control
        )
        rows = np.concatenate([state[None], path[0][steps - 1 :: steps][:-1]])[:, 1:3]
        read = np.stack(
            [_delayed(column, value["sensor.delay"], period) for column in rows.T], axis=1
        )
        read[:, 0] += value["encoder.bias"]
        return np.asarray(read)


def edited(value: Mapping[str, float]) -> mujoco.MjModel:
    """The compiled pendulum with the values of its joint and link."""
    spec = mujoco.MjSpec.from_string(_XML)
    joint = spec.joint("hinge")
    joint.damping = np.array([value["joint.damping"], 0.0, 0.0])
    joint.stiffness = np.array([value["joint.stiffness"], 0.0, 0.0])
    joint.frictionloss = value["joint.friction"]
    joint.armature = value["joint.armature"]
    spec.geom("rod").mass = value["link.mass"]
    return spec.compile()


def _delayed(column: FloatArray, delay: float, period: float) -> FloatArray:
    """The column a delay [s] ago, linear between rows a period [s] apart, its ends held."""
    if delay == 0.0:
        return column
    time = period * np.arange(len(column))
    return np.asarray(np.interp(time - delay, time, column))
