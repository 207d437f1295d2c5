"""missing_efforts: what a measured motion asks of the joints beyond the model and its commands."""

from __future__ import annotations

from collections.abc import Mapping

import mujoco
import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.machines.mjcf.motion.inverse import moved_along, needed_commands, needed_effort
from ves_twin.machines.mjcf.motion.work import Work, measured_variables
from ves_twin.machines.mjcf.rig.places import driven_joint

INERTIA = (
    *("body_mass", "body_inertia", "body_ipos", "body_iquat", "body_pos", "body_quat"),
    *("jnt_pos", "jnt_axis", "dof_armature", "tendon_armature"),
)
"""Numbers of a model that its mass matrix depends on."""


def missing_efforts(
    work: Work, positions: Mapping[str, FloatArray], as_nominal: bool
) -> tuple[dict[str, FloatArray], dict[str, FloatArray]] | None:
    """Efforts [N, N m] by joint, and the variables of laws, along a motion: (n,) each.

        missing = M(q) a + c(q, v) - command

    c has weight, springs and friction. It is linear in what the model lacks at any loudness, where
    a simulation is not. As acceleration is noisy, it is least of a model without any mass: to fit
    masses by, M_0(q) M(q)^-1 missing is M_0 times the acceleration beyond the model's.

    Args:
        work: whose programme has the commands of the actuators.
        positions: of every joint of one coordinate, smooth (n,).
        as_nominal: as efforts of the nominal masses M_0.

    Returns:
        None where a contact, limit or equality is at work: its force is no law of the motion. None,
        too, where a motor drives a tendon, or two of them one joint.
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
    driven = [driven_joint(model, name) for name in fed]
    if not all(driven) or len(set(driven)) < len(driven):
        return None
    own = np.zeros((rows, model.nv))
    for joint in positions:
        own[:, int(model.joint(joint).dofadr[0])] = needed_effort(work, joint, moved)
    for name, need in needed_commands(work, [*fed], moved).items():
        actuator = model.actuator(name)
        gain = float(actuator.gear[0]) * float(actuator.gainprm[0])
        dof = int(model.joint(driven_joint(model, name)).dofadr[0])
        own[:, dof] = gain * (need - programme.drive[fed[name]][:, 0])
    lacking = _with_masses_of(work.rig.model, model, q, own) if as_nominal else own
    efforts = {j: lacking[:, int(model.joint(j).dofadr[0])] for j in positions}
    return efforts, measured_variables(work, np.hstack([q, v]))


def _with_masses_of(
    nominal: mujoco.MjModel, model: mujoco.MjModel, q: FloatArray, efforts: FloatArray
) -> FloatArray:
    """Efforts (n, nv) that accelerate a nominal model as these do a model: M_0 M^-1 tau."""
    if all(np.array_equal(getattr(nominal, name), getattr(model, name)) for name in INERTIA):
        return efforts
    data, first = mujoco.MjData(model), mujoco.MjData(nominal)
    found, pull = np.zeros_like(efforts), np.zeros((1, model.nv))
    for k, row in enumerate(q):
        for one, its in ((model, data), (nominal, first)):
            its.qpos[:] = row
            mujoco.mj_kinematics(one, its)
            mujoco.mj_comPos(one, its)
            mujoco.mj_makeM(one, its)
        mujoco.mj_factorM(model, data)
        mujoco.mj_solveM(model, data, pull, efforts[k : k + 1])
        mujoco.mj_mulM(nominal, first, found[k], pull[0])
    return found
