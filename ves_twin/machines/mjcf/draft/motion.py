"""Motion: efforts that a model needs for a recorded motion, in the band that a log resolves."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass

import mujoco
import numpy as np
from scipy.signal import welch

from ves_twin.core.types import FloatArray
from ves_twin.machines.mjcf.parts.loop_motion import LoopMotion
from ves_twin.machines.mjcf.parts.ties import Ties

MOST = 1500
"""Rows at which the efforts are computed: enough to tell a sign, and a tenth of a second."""

MOST_CLOSED = 150
"""The same where loops must be closed at each, which takes longer."""


@dataclass(frozen=True)
class Motion:
    """Efforts of the joints along a motion, at some of its rows.

    Attributes:
        rows: numbers of these rows (m,).
        speed: of the degrees of freedom (m, nv).
        effort: needed at each, of the model as it is (m, nv).
        steady: of them what gravity, springs and speeds need (m, nv); the rest is inertia.
        open: share of the rows in which loops of the model do not close, which are left out; where
            all are, efforts are none.
    """

    rows: np.ndarray
    speed: FloatArray
    effort: FloatArray
    steady: FloatArray
    open: float = 0.0


def motion_of(
    model: mujoco.MjModel,
    positions: Mapping[str, FloatArray],
    period: float,
    corner: float,
    loops: bool = False,
    pushed: Collection[str] = (),
) -> Motion:
    """MuJoCo's inverse dynamics along recorded positions that are low-passed without phase.

    Args:
        model: without contacts of interest.
        positions: joint -> position [m or rad] (n,) at even rows; others stay where they are.
        period: of the rows [s].
        corner: of that low-pass [Hz], of which a period is left out at both ends.
        loops: others move as the model's loops have it, and what they need is needed at those
            whose positions are told.
        pushed: joints that have efforts: what joints that follow these need is needed there.
    """
    count = len(next(iter(positions.values())))
    trim = min(int(1.0 / (corner * period)), count // 8)
    most = MOST_CLOSED if loops else MOST
    rows = np.unique(np.linspace(trim, count - 1 - trim, most).astype(int))
    q = np.tile(model.qpos0, (len(rows), 1))
    v, a = np.zeros((2, len(rows), model.nv))
    for joint, values in positions.items():
        at, dof = int(model.joint(joint).qposadr[0]), int(model.joint(joint).dofadr[0])
        speed = np.gradient(values, period)
        q[:, at], v[:, dof] = values[rows], speed[rows]
        a[:, dof] = np.gradient(speed, period)[rows]
    if not loops:
        ties, coasts = Ties.of(model, positions, pushed), np.zeros_like(a)
        ties.follow(model, (q, v, coasts))
        ties.follow(model, (q, v, a))
        effort, steady = (ties.at_leaders(model, q, one) for one in _needed(model, q, v, a, coasts))
        return Motion(rows, v, effort, steady)
    joints = [model.joint(joint) for joint in positions]
    drives = np.array([int(joint.dofadr[0]) for joint in joints])
    along = q[:, [int(joint.qposadr[0]) for joint in joints]]
    driven = a[:, drives]
    moved = LoopMotion.of(model, drives, along, v[:, drives], driven)
    coasts = moved.pull - np.einsum("kvd,kd->kv", moved.ways, driven)
    both = _needed(model, moved.position, moved.speed, moved.pull, coasts)
    effort, steady = np.zeros((2, len(rows), model.nv))
    effort[:, drives], steady[:, drives] = (moved.at_drives(one) for one in both)
    kept = ~moved.open if not np.all(moved.open) else np.ones(len(rows), dtype=bool)
    share = float(np.mean(moved.open))
    return Motion(rows[kept], moved.speed[kept], effort[kept], steady[kept], share)


def _needed(
    model: mujoco.MjModel, q: FloatArray, v: FloatArray, a: FloatArray, coasts: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Efforts (m, nv) of an open tree along qpos, qvel and qacc, and those at qacc of coasting."""
    quiet = model.opt.disableflags
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    try:
        data = mujoco.MjData(model)
        effort, steady = np.zeros((2, *v.shape))
        position, speed, pull, needed = data.qpos, data.qvel, data.qacc, data.qfrc_inverse
        for k in range(len(q)):
            position[:], speed[:], pull[:] = q[k], v[k], a[k]
            mujoco.mj_inverse(model, data)
            effort[k] = needed
            pull[:] = coasts[k]
            mujoco.mj_inverseSkip(model, data, mujoco.mjtStage.mjSTAGE_VEL, 1)
            steady[k] = needed
    finally:
        model.opt.disableflags = quiet
    return effort, steady


def spectrum(values: FloatArray, period: float) -> tuple[FloatArray, FloatArray]:
    """Frequencies [Hz] and power per Hz of a column."""
    rows = min(len(values) // 4, 1024)
    found = welch(values - values.mean(), 1.0 / period, nperseg=rows, detrend="linear")
    return np.asarray(found[0]), np.asarray(found[1])


def band_of(values: FloatArray, period: float, share: float) -> float:
    """Frequency [Hz] below which a share of a column's power lies."""
    frequency, power = spectrum(values, period)
    sums = np.cumsum(power)
    return float(frequency[min(int(np.searchsorted(sums, share * sums[-1])), len(sums) - 1)])
