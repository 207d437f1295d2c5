"""missing_efforts: what a measured motion asks of the joints beyond the model and its commands."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.machines.mjcf.inverse import moved_along, needed_commands, needed_effort
from ves_twin.machines.mjcf.places import driven_joint
from ves_twin.machines.mjcf.work import Work, variables


def missing_efforts(
    work: Work, positions: Mapping[str, FloatArray]
) -> tuple[dict[str, FloatArray], dict[str, FloatArray]] | None:
    """Efforts [N, N m] by joint, and the variables of laws, along a motion: (n,) each.

    Inverse dynamics gives the command that each actuator needs, u = M(q) a + c(q, v) over its
    gain; what it needs beyond what was commanded, times the gain, is an effort that the model
    lacks; of a joint that nothing drives it is all that the motion needs. It is linear in what is
    missing at any loudness, where a simulation is not.

    Args:
        work: whose programme has the commands of the actuators.
        positions: of every joint of one coordinate, smooth (n,).

    Returns:
        None where a contact, limit or equality is at work: its force is no law of the motion.
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
    moved = moved_along(work, q, v, a)
    if moved.bound:
        return None
    fed = work.rig.description.drive.actuators
    driven = {driven_joint(model, name) for name in fed}
    efforts = {j: needed_effort(work, j, moved) for j in positions if j not in driven}
    for name, need in needed_commands(work, [*fed], moved).items():
        actuator = model.actuator(name)
        gain = float(actuator.gear[0]) * float(actuator.gainprm[0])
        efforts[driven_joint(model, name)] = gain * (need - programme.drive[fed[name]][:, 0])
    found = variables(model, programme.time, np.hstack([q, v]))
    return efforts, found | {f"command@{n}": programme.drive[s][:, 0] for n, s in fed.items()}
