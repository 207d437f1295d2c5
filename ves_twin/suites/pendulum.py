"""BlindPendulum: measured pendulums by Runge-Kutta at half the step, with noise of another sort."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import final

import mujoco
import numpy as np
from mujoco import rollout
from scipy.signal import lfilter

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.core.signals import Role, Signal
from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.forward import Excitation
from ves_twin.machines.pendulum.forward import CHANNELS, START, STEP, Pendulum, edited
from ves_twin.suites.bench import BlindBench, BlindRig

COUNT = 2e-4
"""Encoder step [rad]: a fifth of its noise."""

DISTURBANCE = 2e-4
"""Sd of a torque disturbance that no model has [N m], low-passed at about 4 Hz."""

SECONDS = 4.0
"""Length of a record [s]."""

_ASKED = {
    "train": (1, 0.45, 2.5),
    "held_out": (2, 0.45, 2.5),
    "poor": (3, 0.06, 0.3),
    "standstill": (1, 0.0, 2.5),
}
"""Programme -> number of its draw, amplitude of a tone [N m], fastest tone [Hz]."""

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

    def record(
        self, rig: BlindRig, programme: str, rng: np.random.Generator, lead: float = 0.0
    ) -> Recording:
        """A multisine with the resonance (0.9 Hz) inside its band, a faint slow one, or no torque.

        Raises:
            InvalidInputError: no such programme.
        """
        if programme not in _ASKED:
            raise InvalidInputError("programme", programme, f"one of {', '.join(_ASKED)}")
        number, amplitude, fastest = _ASKED[programme]
        torque = asked_torque(number, amplitude, fastest, SECONDS + lead)
        if programme == "poor":  # next to no inertia: mass, gain and spring look alike
            torque *= np.sin(np.linspace(0.0, np.pi, len(torque))) ** 2
        if programme == "standstill":
            return self._measured(rig, np.zeros(4 * len(torque)), None, rng)
        whole = self._measured(rig, torque, (0.0, 0.0), rng)
        first = round(lead / STEP)
        signals = {name: values[first:] for name, values in whole.signals.items()}
        return replace(whole, time=_rows(len(torque) - first), signals=signals)

    def play(self, rig: BlindRig, programme: Excitation, rng: np.random.Generator) -> Recording:
        """A torque from a given start."""
        torque = programme.drive["joint.torque"][:, 0]
        start = programme.drive[START.name][0]
        found = self._measured(rig, torque, (float(start[0]), float(start[1])), rng)
        signals = {**found.signals, START.name: np.tile(start, (len(torque), 1))}
        info = replace(found.info, own_signals=(*SIGNALS_OF_ITS_OWN, START))
        return replace(found, signals=signals, info=info)

    def _measured(
        self,
        rig: BlindRig,
        torque: FloatArray,
        start: tuple[float, float] | None,
        rng: np.random.Generator,
    ) -> Recording:
        """From a start but for its commissioning error; clamped if None."""
        value = {p.name: p.nominal for p in self.forward.parameters} | dict(rig.values)
        model = _model(value, rig)
        n = len(torque)
        shaken = lfilter([0.05], [1.0, -0.95], rng.standard_normal(n)) * DISTURBANCE / 0.16
        late = np.interp(_rows(n) - value["command.delay"], _rows(n), torque)
        applied = value["drive.gain"] * late + value["drive.offset"] + shaken
        begun = np.zeros(2)
        if start is None:
            applied[:] = 0.0
        else:
            begun = np.add(start, (value["start.angle"], value["start.rate"]))
        read = _read(_moved(model, applied, begun), value, rig, rng)
        signals = {
            "joint.torque": torque[:, None],
            "joint.angle": read[:, :1],
            "joint.rate": read[:, 1:],
        }
        info = RecordingInfo(
            "measured", scenario="pendulum", period=STEP, own_signals=SIGNALS_OF_ITS_OWN
        )
        return Recording(_rows(n), signals, info)


def asked_torque(
    seed: int, amplitude: float = 0.45, fastest: float = 2.5, seconds: float = SECONDS
) -> FloatArray:
    """Five tones from 0.2 Hz up [N m]."""
    rng = np.random.default_rng(seed)
    time = _rows(round(seconds / STEP))
    tones = zip(rng.uniform(0.2, fastest, 5), rng.uniform(0, 2.0 * np.pi, 5), strict=True)
    return np.asarray(amplitude * sum(np.sin(2 * np.pi * f * time + a) for f, a in tones))


def _rows(n: int) -> FloatArray:
    return np.asarray(STEP * np.arange(n))


def _model(value: Mapping[str, float], rig: BlindRig) -> mujoco.MjModel:
    model = edited(value)
    model.opt.timestep = STEP / 2
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
    tilt, stop = rig.odd("gravity_tilt"), rig.odd("soft_stop")
    model.opt.gravity[:] = 9.81 * np.array([np.sin(tilt), 0.0, -np.cos(tilt)])
    model.dof_dampingpoly[0, 0] = rig.odd("quadratic_drag")
    if stop:
        model.jnt_limited[0], model.jnt_range[0] = 1, (-0.12, 3.0)
        model.jnt_solref[0] = (-40.0 * stop, -stop)
    return model


def _moved(model: mujoco.MjModel, torque: FloatArray, start: FloatArray) -> FloatArray:
    """Angle and rate at every half step (2 n, 2)."""
    state = np.zeros(mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS))
    state[1:3] = start
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
    angle = angle + rig.odd("late_drift") * (time / time[-1]) ** 2
    if rig.odd("offset_step"):
        angle = angle + rig.odd("offset_step") * (time > time[-1] * rng.uniform(0.3, 0.7))
    angle = angle + rig.odd("line") * np.sin(2.0 * np.pi * 9.0 * time)
    if rig.odd("encoder_hysteresis"):
        angle = _with_play(angle, rig.odd("encoder_hysteresis"))
    if rig.odd("stuck_samples"):
        held = round(rig.odd("stuck_samples"))
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
