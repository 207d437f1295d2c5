"""BlindPendulum: measured pendulums by Runge-Kutta at half the step, with noise of another sort."""

from __future__ import annotations

from collections.abc import Mapping
from typing import final

import mujoco
import numpy as np
from mujoco import rollout
from scipy.signal import lfilter

from ves_twin.benches.pendulum import CHANNELS, STEP, Pendulum, edited
from ves_twin.blind.bench import BlindBench, BlindRig
from ves_twin.recording.recording import Recording, RecordingInfo
from ves_twin.signals import Role, Signal
from ves_twin.types import FloatArray

COUNT = 2e-4
"""Encoder step [rad]: a fifth of its noise."""

DISTURBANCE = 2e-4
"""Sd of a torque disturbance that no model has [N m], low-passed at about 4 Hz."""

SECONDS = 4.0
"""Length of a record [s]."""

SIGNALS_OF_ITS_OWN = (
    Signal("joint.torque", ("",), ("N*m",), Role.COMMAND, "joint", "torque that was asked for"),
    Signal("joint.angle", ("",), ("rad",), Role.MEASUREMENT, "joint", "encoder"),
    Signal("joint.rate", ("",), ("rad/s",), Role.MEASUREMENT, "joint", "rate sensor"),
)

OUTSIDE = {
    "quadratic_drag": (0.005, 0.05),
    "gravity_tilt": (0.01, 0.1),
    "late_drift": (0.01, 0.1),
    "offset_step": (0.005, 0.05),
    "line": (0.003, 0.02),
    "encoder_hysteresis": (0.003, 0.02),
    "soft_stop": (1.0, 10.0),
    "stuck_samples": (3.0, 12.0),
}
"""Kinds that the library lacks: drag [N m s^2/rad^2], gravity off the vertical [rad], drift that
grows with the square of time [rad], a step of the encoder [rad], a line of 9 Hz on it [rad], its
backlash [rad], a stop within the range [N m/rad], and samples that repeat [rows]."""


@final
class BlindPendulum(BlindBench):
    """The pendulum of the peers' table, measured."""

    @property
    def forward(self) -> Pendulum:
        """With the delay of the command in the library, a twin of the sensor's."""
        return Pendulum.with_command_delay()

    @property
    def outside(self) -> Mapping[str, tuple[float, float]]:
        """Edits of the model and of what was read."""
        return OUTSIDE

    @property
    def confusable(self) -> tuple[str, ...]:
        """The two delays."""
        return ("delay@sensor", "delay@command")

    def record(self, rig: BlindRig, programme: str, rng: np.random.Generator) -> Recording:
        """A multisine with the resonance (0.9 Hz) inside its band, or no torque at all."""
        torque = asked_torque({"train": 1, "held_out": 2}.get(programme, 1))
        if programme == "standstill":
            torque = np.zeros(4 * len(torque))
        value = {p.name: p.nominal for p in self.forward.parameters} | dict(rig.values)
        model = _model(value, rig)
        n = len(torque)
        shaken = lfilter([0.05], [1.0, -0.95], rng.standard_normal(n)) * DISTURBANCE / 0.16
        late = np.interp(_rows(n) - value["command.delay"], _rows(n), torque)
        applied = value["drive.gain"] * late + value["drive.offset"] + shaken
        if programme == "standstill":
            applied[:] = value["start.angle"] = value["start.rate"] = 0.0
        read = _read(_moved(model, applied, value), value, rig, rng)
        signals = {
            "joint.torque": torque[:, None],
            "joint.angle": read[:, :1],
            "joint.rate": read[:, 1:],
        }
        info = RecordingInfo(
            "measured", scenario="pendulum", period=STEP, own_signals=SIGNALS_OF_ITS_OWN
        )
        return Recording(_rows(n), signals, info)


def asked_torque(seed: int, amplitude: float = 0.45) -> FloatArray:
    """Five tones from 0.2 to 2.5 Hz [N m]."""
    rng = np.random.default_rng(seed)
    time = _rows(round(SECONDS / STEP))
    tones = zip(rng.uniform(0.2, 2.5, 5), rng.uniform(0, 2.0 * np.pi, 5), strict=True)
    return np.asarray(amplitude * sum(np.sin(2 * np.pi * f * time + a) for f, a in tones))


def _rows(n: int) -> FloatArray:
    return np.asarray(STEP * np.arange(n))


def _model(value: Mapping[str, float], rig: BlindRig) -> mujoco.MjModel:
    model = edited(value)
    model.opt.timestep = STEP / 2
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
    if rig.outside == "gravity_tilt":
        model.opt.gravity[:] = 9.81 * np.array([np.sin(rig.size), 0.0, -np.cos(rig.size)])
    elif rig.outside == "quadratic_drag":
        model.dof_dampingpoly[0, 0] = rig.size
    elif rig.outside == "soft_stop":
        model.jnt_limited[0], model.jnt_range[0] = 1, (-0.12, 3.0)
        model.jnt_solref[0] = (-40.0 * rig.size, -rig.size)
    return model


def _moved(model: mujoco.MjModel, torque: FloatArray, value: Mapping[str, float]) -> FloatArray:
    """Angle and rate at every half step (2 n, 2)."""
    state = np.zeros(mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS))
    state[1], state[2] = value["start.angle"], value["start.rate"]
    control = np.repeat(torque, 2)[None, :, None]
    path, _ = rollout.rollout(
        model, mujoco.MjData(model), initial_state=state[None], control=control
    )
    return np.asarray(np.concatenate([state[None], path[0][:-1]])[:, 1:3])


def _read(
    rows: FloatArray, value: Mapping[str, float], rig: BlindRig, rng: np.random.Generator
) -> FloatArray:
    """Delay, bias, what is outside the library, noise of another level and colour, counts."""
    n = len(rows) // 2
    time, fine = _rows(n), STEP / 2 * np.arange(2 * n)
    read = np.stack(
        [np.interp(time - value["sensor.delay"], fine, column) for column in rows.T], axis=1
    )
    angle = read[:, 0] + value["encoder.bias"]
    if rig.outside == "late_drift":
        angle = angle + rig.size * (time / time[-1]) ** 2
    elif rig.outside == "offset_step":
        angle = angle + rig.size * (time > time[-1] * rng.uniform(0.3, 0.7))
    elif rig.outside == "line":
        angle = angle + rig.size * np.sin(2.0 * np.pi * 9.0 * time)
    elif rig.outside == "encoder_hysteresis":
        angle = _with_play(angle, rig.size)
    elif rig.outside == "stuck_samples":
        held = round(rig.size)
        angle = angle[np.arange(n) // held * held]
    level, colour = rng.uniform(0.9, 1.12), rng.uniform(0.0, 0.15)
    white = level * rng.standard_normal((n, 2)) * [c.sd for c in CHANNELS]
    noise = lfilter([1.0], [1.0, -colour], white, axis=0)
    angle = COUNT * np.round((angle + noise[:, 0]) / COUNT)
    return np.stack([angle, read[:, 1] + noise[:, 1]], axis=1)


def _with_play(column: FloatArray, width: float) -> FloatArray:
    out = column.copy()
    for k in range(1, len(column)):
        out[k] = min(max(out[k - 1], column[k] - width / 2), column[k] + width / 2)
    return out
