"""is_cyclic: whether a joint's position changes no effort, so that its speed tells all of it."""

from __future__ import annotations

import mujoco
import numpy as np
from scipy.integrate import cumulative_trapezoid

from ves_twin.core.types import FloatArray
from ves_twin.machines.mjcf.parts.ties import Ties

STATES = 3
"""States, drawn at random, in which a joint is turned: in one alone little may hang on it."""

ROUNDING = 1e-9
"""Share of the largest effort by which efforts may differ and be the same."""


def is_cyclic(model: mujoco.MjModel, joint: str) -> bool:
    """Whether efforts of all joints are the same wherever a joint stands, as of a reaction wheel.

    By inverse dynamics of states drawn at random, the joint where it is drawn and elsewhere. Of
    joints that equalities tie to it the same, and each turns in proportion.

    Args:
        model: without contacts of interest.
        joint: of one coordinate.
    """
    after = Ties.of(model, (joint,)).followers
    if any(any(one.powers[2:]) or not _is_alone(model, one.joint) for one in after):
        return False
    return _is_alone(model, joint)


def _is_alone(model: mujoco.MjModel, joint: str) -> bool:
    """The same of one joint, without those that it moves."""
    at, rng = int(model.joint(joint).qposadr[0]), np.random.default_rng(0)
    quiet = model.opt.disableflags
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    try:
        data = mujoco.MjData(model)
        for _ in range(STATES):
            move, efforts = rng.standard_normal((3, model.nv)), []
            for elsewhere in (0.0, rng.uniform(1.0, 2.0)):
                data.qpos[:] = model.qpos0
                mujoco.mj_integratePos(model, data.qpos, move[0], 1.0)
                data.qpos[at] += elsewhere
                data.qvel[:], data.qacc[:] = move[1], move[2]
                mujoco.mj_inverse(model, data)
                efforts.append(data.qfrc_inverse.copy())
            if np.ptp(efforts, axis=0).max() > ROUNDING * np.abs(efforts).max():
                return False
    finally:
        model.opt.disableflags = quiet
    return True


def turned_by(speed: FloatArray, time: FloatArray) -> FloatArray:
    """Position (n,) from where it began, of a speed (n,) at times [s] (n,)."""
    return np.asarray(cumulative_trapezoid(speed, time, initial=0.0))
