"""fill_filters: actuators behind a filter begin with what is in it, not with nothing."""

from __future__ import annotations

import mujoco
import numpy as np
from scipy.signal import lfilter

from ves_twin.core.types import FloatArray
from ves_twin.machines.mjcf.parts.servo import FILTERS, is_servo


def fill_filters(
    model: mujoco.MjModel, data: mujoco.MjData, commands: FloatArray, period: float
) -> None:
    """Set the activation a of filtered actuators where a motion begins.

    By the commands u of earlier rows, where there are some:

        a[k] = a[k-1] + (u[k-1] - a[k-1]) (1 - exp(-T / tau)),   a[0] = u[0]

    Else of a servo by its joint, which it holds against gravity and the model's own friction and
    springs: kp (a - q) - kv v = what these take; one without a kp holds nothing. Else as if the
    first command had been there long. MuJoCo begins with zero, from where a servo would fall.

    Args:
        model: with its actuators.
        data: of it where the motion begins; its activations are changed.
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
        if len(column) > 1:
            tau = max(float(model.actuator_dynprm[number, 0]), 1e-12)
            share = -np.expm1(-period / tau)
            begin = np.array([(1.0 - share) * column[0]])
            filled = lfilter([share], [1.0, share - 1.0], column[:-1], zi=begin)[0][-1]
        else:
            filled = _held(model, data, number) if is_servo(model, number) else column[0]
        data.act[int(model.actuator_actadr[number])] = filled


def _held(model: mujoco.MjModel, data: mujoco.MjData, number: int) -> float:
    """Where a servo is told to be whose joint is where it is, without acceleration."""
    joint = int(model.actuator_trnid[number, 0])
    dof = int(model.jnt_dofadr[joint])
    stiffness, damping = (-float(one) for one in model.actuator_biasprm[number, 1:3])
    load = float(data.qfrc_bias[dof] - data.qfrc_passive[dof])
    moving = damping * float(data.qvel[dof])
    place = float(data.qpos[int(model.jnt_qposadr[joint])])
    return place + (load + moving) / stiffness if stiffness > 0.0 else place
