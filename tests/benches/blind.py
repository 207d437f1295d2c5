"""Blind pendulums: data from another integrator, step and noise than the diagnosis assumes.

Classic Runge-Kutta at half the step, every commissioning parameter redrawn, noise of another
level and colour, an encoder that counts, and a torque disturbance that no model has.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import mujoco
import numpy as np
from mujoco import rollout
from scipy.signal import lfilter

from ves_twin.benches.pendulum import CHANNELS, PARAMETERS, STEP, edited
from ves_twin.recording.recording import Recording, RecordingInfo

COUNT = 2e-4
"""Encoder step [rad]: a fifth of its noise."""

DISTURBANCE = 2e-4
"""Sd of the torque disturbance [N m], low-passed at about 4 Hz."""


@dataclass(frozen=True)
class Outside:
    """Effects that the library lacks: quadratic drag, gravity in another direction, drift, dead
    time by repeated samples."""

    drag: float = 0.0
    tilt: float = 0.0
    drift: float = 0.0


def programme_rows(seed: int, seconds: float = 4.0, amplitude: float = 0.45) -> np.ndarray:
    """A multisine of torque [N m] with resonance (0.9 Hz) inside its band."""
    rng = np.random.default_rng(seed)
    time = STEP * np.arange(round(seconds / STEP))
    tones = zip(rng.uniform(0.2, 2.5, 5), rng.uniform(0, 6.28, 5), strict=True)
    return amplitude * sum(np.sin(2 * np.pi * f * time + a) for f, a in tones)


def blind_record(
    rng: np.random.Generator,
    torque: np.ndarray,
    hidden: Mapping[str, float] | None = None,
    outside: Outside | None = None,
    spread: float = 1.0,
) -> Recording:
    """A measured pendulum.

    Args:
        rng: of everything that is drawn.
        torque: asked for [N m] (n,).
        hidden: parameter -> departure of the hidden effect.
        outside: effects that the library lacks.
        spread: of the commissioning errors, in declared sd.
    """
    value = {p.name: p.nominal + spread * p.sd * rng.standard_normal() for p in PARAMETERS}
    for name, size in (hidden or {}).items():
        value[name] += size
    outside = outside or Outside()
    model = edited(value)
    model.opt.timestep = STEP / 2
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
    model.opt.gravity[:] = 9.81 * np.array([np.sin(outside.tilt), 0.0, -np.cos(outside.tilt)])
    if outside.drag:
        model.dof_dampingpoly[0, 0] = outside.drag  # N m s^2 / rad^2, beside the linear one
    n = len(torque)
    shaken = lfilter([0.05], [1.0, -0.95], rng.standard_normal(n)) * DISTURBANCE / 0.16
    applied = value["drive.gain"] * torque + value["drive.offset"] + shaken
    state = np.zeros(mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS))
    state[1], state[2] = value["start.angle"], value["start.rate"]
    control = np.repeat(applied, 2)[None, :, None]
    path, _ = rollout.rollout(
        model, mujoco.MjData(model), initial_state=state[None], control=control
    )
    rows = np.concatenate([state[None], path[0][:-1]])[:, 1:3]
    time = STEP * np.arange(n)
    lag = value["sensor.delay"]
    fine = STEP / 2 * np.arange(2 * n)
    read = np.stack([np.interp(time - lag, fine, column) for column in rows.T], axis=1)
    read[:, 0] += value["encoder.bias"] + outside.drift * (time / time[-1]) ** 2
    level, colour = rng.uniform(0.9, 1.12), rng.uniform(0.0, 0.15)
    white = level * rng.standard_normal((n, 2)) * [c.sd for c in CHANNELS]
    read = read + lfilter([1.0], [1.0, -colour], white, axis=0)
    read[:, 0] = COUNT * np.round(read[:, 0] / COUNT)
    signals = {
        "joint.torque": torque[:, None],
        "joint.angle": read[:, :1],
        "joint.rate": read[:, 1:],
    }
    return Recording(time, signals, RecordingInfo("measured", scenario="pendulum"))
