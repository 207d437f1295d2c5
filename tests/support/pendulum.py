"""The shipped pendulum for tests: its forward, its generator, its torque."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.machines.mjcf.inputs.programmes import multisine
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.rig.machine import Rig
from ves_twin.suites.mjcf import BlindMjcf

STEP = 0.002
"""Time between rows [s]."""

MACHINE = Rig.load("pendulum")
DELAYED = MjcfForward.of(MACHINE)
"""With the delays of command and sensors, which a recording from rest does not tell apart."""

BLIND = BlindMjcf(MACHINE)
SDS = [0.001, 0.01]
"""Noise of angle [rad] and rate [rad/s]."""

FRICTION = "coulomb_friction@joint:level"
SPRING = "joint_spring@joint:stiffness"
LATE = "sensor_delay@joint:delay"
LATE_COMMAND = "actuator_delay@drive:delay"
BIAS = "sensor_offset@joint.angle.1:offset"
GAIN = "actuator_gain@drive:gain"
MASS = "body_mass@link:mass"
INERTIA = "rotor_inertia@joint:inertia"
DAMPING = "viscous_friction@joint:damping"
ZERO = "force_offset@joint:offset"
ANGLE, RATE = "start@joint:position", "start@joint:speed"


def exact(**sd: float) -> MjcfForward:
    """The pendulum whose command is not late; every number known to `sd`, if that is given."""
    told = MACHINE.description
    effects = [e for e in told.effects if e.kind != "actuator_delay"]
    changes = {
        "effects": tuple(e.model_copy(update=sd) for e in effects),
        "parameters": tuple(s.model_copy(update=sd) for s in told.parameters),
        "start": {"joint": told.start["joint"].model_copy(update=sd and sd | {"speed_sd": 0.0})},
    }
    return MjcfForward.of(replace(MACHINE, description=told.model_copy(update=changes)))


PLANT = exact()
FED = multisine(MACHINE, np.random.default_rng(1), 4.0)
TIME, TORQUE = FED.time, FED.drive["joint.torque"]


def fed(torque: np.ndarray) -> Excitation:
    """A torque (n,) from rest."""
    return Excitation("", STEP * np.arange(len(torque)), {"joint.torque": torque[:, None]})
