"""unmeasured: typical sizes that no column tells, as the model moves its joints."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import mujoco
import numpy as np

from ves_twin.core.recording.recording import Recording
from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.machines.mjcf.draft.estimates import travel, typical
from ves_twin.machines.mjcf.draft.spots import is_motor, single_joints
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.motion.started import read_from, signal_of
from ves_twin.machines.mjcf.parts.cyclic import turned_by
from ves_twin.machines.mjcf.parts.joint_units import joint_units
from ves_twin.machines.mjcf.rig.column import Column
from ves_twin.machines.mjcf.rig.description import Compared
from ves_twin.machines.mjcf.rig.machine import Rig
from ves_twin.machines.mjcf.rig.places import driven_joint

MOST = 300
"""Rows along which efforts are computed: enough for a typical one."""


def unmeasured(rig: Rig, recording: Recording) -> dict[str, dict[str, float]]:
    """Effort, speed and travel of joints without a column, along the motion that a model makes.

    The effort is that of the joint's own spring and damper, k (q - q0) + d dq, of gravity and
    speeds, or of a motor that is fed in there, whichever is more; in loops, which carry a part of
    the weight, without that. Of a joint whose motion alone is told, the effort.

    Args:
        rig: a drafted machine.
        recording: what it is fed with.

    Returns:
        Joint -> effort, speed, travel in SI, those that are above zero.
    """
    told, model = rig.description, rig.model
    every = [model.joint(i).name for i in single_joints(model)]
    known = {*told.drive.imposed, *told.drive.locked}
    known |= {name for name, sizes in told.typical.joint.items() if sizes.effort}
    names = [name for name in every if name not in known]
    if not names:
        return {}
    every = [name for name in every if name not in {*told.drive.imposed, *told.drive.locked}]
    signals, compared = dict(told.signals), dict(told.compare)
    spun = [name for name in every if signal_of(told, name, "speed") and read_from(told, name)[1]]
    for name in every:
        for of, unit in zip(("position", "speed"), joint_units(model, name), strict=True):
            if name in spun and of == "position":
                continue  # its start is read from its speed, as no row tells this
            signals[f"{of} of {name}"] = Column(columns=(f"{of} of {name}",), unit=unit)
            compared[f"{of} of {name}"] = Compared(joint=name, of=of)  # type: ignore[arg-type]
    seen = replace(
        rig, description=told.model_copy(update={"signals": signals, "compare": compared})
    )
    forward = MjcfForward.of(seen)
    rows = forward.simulate(Excitation.of(recording, forward.drive), {})
    moved = dict(zip([channel.signal for channel in forward.channels], rows.T, strict=True))
    for name in spun:
        begin = float(model.qpos0[int(model.joint(name).qposadr[0])])
        moved[f"position of {name}"] = begin + turned_by(moved[f"speed of {name}"], recording.time)
    for name, signal in told.drive.imposed_signals.items():
        moved[f"position of {name}"] = q = recording[signal][:, 0]
        moved[f"speed of {name}"] = np.gradient(q, recording.time)
    efforts, found = _efforts(model, moved), dict[str, dict[str, float]]()
    for name in names:
        most = max(efforts[name], _driven(rig, name, recording))
        sizes = {"effort": most}
        if name not in told.typical.joint:
            q, speed = moved[f"position of {name}"], moved[f"speed of {name}"]
            sizes |= {"speed": typical(speed), "travel": travel(q)}
        found[name] = {k: v for k, v in sizes.items() if np.isfinite(v) and v > 0.0}
    return {name: sizes for name, sizes in found.items() if sizes}


def _efforts(model: mujoco.MjModel, moved: Mapping[str, FloatArray]) -> dict[str, float]:
    """Typical effort of each joint's spring and damper, or of weight and speeds, along a motion."""
    rows = np.unique(np.linspace(0, len(next(iter(moved.values()))) - 1, MOST).astype(int))
    joints = [model.joint(i) for i in single_joints(model)]
    joints = [joint for joint in joints if f"position of {joint.name}" in moved]
    data, own, weight = mujoco.MjData(model), *np.zeros((2, len(rows), model.nv))
    for k, row in enumerate(rows):
        for joint in joints:
            data.qpos[int(joint.qposadr[0])] = moved[f"position of {joint.name}"][row]
            data.qvel[int(joint.dofadr[0])] = moved[f"speed of {joint.name}"][row]
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fwdVelocity(model, data)
        own[k] = data.qfrc_passive - data.qfrc_gravcomp
        weight[k] = 0.0 if model.neq else data.qfrc_bias - data.qfrc_gravcomp
    dofs = {joint.name: int(joint.dofadr[0]) for joint in joints}
    return {n: max(typical(own[:, dof]), typical(weight[:, dof])) for n, dof in dofs.items()}


def _driven(rig: Rig, joint: str, recording: Recording) -> float:
    """Typical effort of the motors of a joint whose commands are fed in; 0 without any."""
    model, found = rig.model, 0.0
    for name, signal in rig.description.drive.actuators.items():
        drive = model.actuator(name)
        if driven_joint(model, name) == joint and is_motor(model, int(drive.id)):
            gain = abs(float(drive.gear[0] * drive.gainprm[0]))
            found = max(found, gain * typical(recording[signal][:, 0]))
    return found
