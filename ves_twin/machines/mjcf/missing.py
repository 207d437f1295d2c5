"""missing_efforts: what a measured motion asks of the joints beyond the model and its commands."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.machines.mjcf.inverse import efforts_along
from ves_twin.machines.mjcf.places import driven_joint
from ves_twin.machines.mjcf.work import Work, variables


def missing_efforts(
    work: Work, positions: Mapping[str, FloatArray]
) -> tuple[dict[str, FloatArray], dict[str, FloatArray]]:
    """Efforts [N, N m] by joint, and the variables of laws, along a motion: (n,) each.

    Inverse dynamics gives the command that each actuator needs, u = M(q) a + c(q, v) over its
    gain; what it needs beyond what was commanded, times the gain, is an effort that the model
    lacks. It is linear in what is missing at any loudness, where a simulation is not.

    Args:
        work: whose programme has the commands of the actuators.
        positions: of every joint of one coordinate, smooth (n,).
    """
    model, programme = work.model, work.programme
    rows = len(programme.time)
    q, v, a = (
        np.tile(model.qpos0, (rows, 1)),
        np.zeros((rows, model.nv)),
        np.zeros((rows, model.nv)),
    )
    for joint, column in positions.items():
        at, dof = int(model.joint(joint).qposadr[0]), int(model.joint(joint).dofadr[0])
        q[:, at] = column
        v[:, dof] = np.gradient(column, programme.period)
        a[:, dof] = np.gradient(v[:, dof], programme.period)
    fed = work.rig.description.drive.actuators
    efforts: dict[str, FloatArray] = {}
    for name, need in efforts_along(work, [*fed], q, v, a).items():
        actuator = model.actuator(name)
        gain = float(actuator.gear[0]) * float(actuator.gainprm[0])
        command = programme.drive[fed[name]][:, 0]
        joint = driven_joint(model, name)
        if joint in positions:
            efforts[joint] = gain * (need - command)
    found = variables(model, programme.time, np.hstack([q, v]))
    return efforts, found | {f"command@{n}": programme.drive[s][:, 0] for n, s in fed.items()}
