"""is_servo, FILTERS: what an actuator of a model makes of its command."""

from __future__ import annotations

import mujoco

FILTERS = (int(mujoco.mjtDyn.mjDYN_FILTER), int(mujoco.mjtDyn.mjDYN_FILTEREXACT))
"""Activations that follow their command behind a time constant."""


def is_servo(model: mujoco.MjModel, actuator: int, geared: bool = False) -> bool:
    """Whether a command, or what a filter leaves of it, is the position a joint is pulled to.

    Args:
        model: of the machine.
        actuator: its number.
        geared: or that times a gear.
    """
    quick = (int(mujoco.mjtDyn.mjDYN_NONE), *FILTERS)
    if int(model.actuator_dyntype[actuator]) not in quick:
        return False
    affine = int(model.actuator_biastype[actuator]) == int(mujoco.mjtBias.mjBIAS_AFFINE)
    pulled = float(model.actuator_gainprm[actuator, 0]) == -float(
        model.actuator_biasprm[actuator, 1]
    )
    on_joint = int(model.actuator_trntype[actuator]) == int(mujoco.mjtTrn.mjTRN_JOINT)
    direct = geared or float(model.actuator_gear[actuator, 0]) == 1.0
    return affine and pulled and on_joint and direct
