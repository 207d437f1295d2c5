"""fill_filters: actuators behind a filter begin with what is in it, not with nothing."""

from __future__ import annotations

import mujoco
import numpy as np
from scipy.signal import lfilter

from ves_twin.core.types import FloatArray
from ves_twin.machines.mjcf.parts.servo import FILTERS, is_servo

LONG = 3.0
"""Time constants of earlier commands from which on they tell what is in a filter: to 5 %."""


def fill_filters(
    model: mujoco.MjModel, data: mujoco.MjData, commands: FloatArray, period: float
) -> None:
    """Set the activation a of filtered actuators where a motion begins.

    By the commands u of earlier rows, where these go back LONG time constants:

        a[k] = a[k-1] + (u[k-1] - a[k-1]) (1 - exp(-T / tau)),   a[0] = u[0]

    Else of a servo that drives its joint alone, by where that is and what it takes there against
    gravity, the model's damping and springs: kp (a - q) - kv v = load. A log may begin with a step.
    Else the same by what rows there are, or as if the first command had been there long. MuJoCo
    begins with zero, from where a servo would fall.

    Args:
        model: with its actuators.
        data: of it where the motion begins, all joints in place; its activations are changed.
        commands: as they reach the actuators, up to the row that is begun with (n, nu).
        period: between rows [s].
    """
    filtered = np.flatnonzero(np.isin(model.actuator_dyntype, FILTERS))
    if len(filtered) == 0:
        return
    mujoco.mj_fwdPosition(model, data)
    mujoco.mj_fwdVelocity(model, data)
    for number in map(int, filtered):
        column = commands[:, number]
        if model.actuator_ctrllimited[number]:
            column = np.clip(column, *model.actuator_ctrlrange[number])
        tau = max(float(model.actuator_dynprm[number, 0]), 1e-12)
        told = (len(column) - 1) * period >= LONG * tau
        servo = is_servo(model, number) and _alone(model, number)
        filled = _held(model, data, number) if servo and not told else _left(column, period / tau)
        data.act[int(model.actuator_actadr[number])] = filled


def _left(column: FloatArray, share: float) -> float:
    """What a filter has at the last of some commands (n,), a row being a share of its tau."""
    if len(column) == 1:
        return float(column[0])
    gain = -np.expm1(-share)
    begin = np.array([(1.0 - gain) * column[0]])
    return float(lfilter([gain], [1.0, gain - 1.0], column[:-1], zi=begin)[0][-1])


def _alone(model: mujoco.MjModel, number: int) -> bool:
    """Whether no other actuator acts on the same joint."""
    on_joint = model.actuator_trntype == int(mujoco.mjtTrn.mjTRN_JOINT)
    return (
        int(np.sum(on_joint & (model.actuator_trnid[:, 0] == model.actuator_trnid[number, 0]))) == 1
    )


def _held(model: mujoco.MjModel, data: mujoco.MjData, number: int) -> float:
    """Where a servo is told to be whose joint is where it is, without acceleration."""
    joint = int(model.actuator_trnid[number, 0])
    dof = int(model.jnt_dofadr[joint])
    stiffness, damping = (-float(one) for one in model.actuator_biasprm[number, 1:3])
    load = float(data.qfrc_bias[dof] - data.qfrc_passive[dof])
    if model.jnt_actgravcomp[joint]:
        load -= float(data.qfrc_gravcomp[dof])
    moving = damping * float(data.qvel[dof])
    place = float(data.qpos[int(model.jnt_qposadr[joint])])
    return place + (load + moving) / stiffness if stiffness > 0.0 else place
