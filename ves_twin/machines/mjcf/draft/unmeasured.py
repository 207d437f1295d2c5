"""unmeasured: typical sizes of joints that no column tells, as the model moves them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ves_twin.core.recording.recording import Recording
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.machines.mjcf.draft.estimates import travel, typical
from ves_twin.machines.mjcf.draft.spots import is_motor, single_joints
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.parts.joint_units import joint_units
from ves_twin.machines.mjcf.rig.column import Column
from ves_twin.machines.mjcf.rig.description import Compared
from ves_twin.machines.mjcf.rig.machine import Rig
from ves_twin.machines.mjcf.rig.places import driven_joint


def unmeasured(rig: Rig, recording: Recording) -> dict[str, dict[str, float]]:
    """Effort, speed and travel of joints without a column, along the motion that a model makes.

    The effort is that of the joint's own spring and damper, k (q - q0) + d dq, or of a motor that
    is fed in there, whichever is more.

    Args:
        rig: a drafted machine.
        recording: what it is fed with.

    Returns:
        Joint -> effort, speed, travel in SI, those that are above zero.
    """
    told, model = rig.description, rig.model
    known = {*told.typical.joint, *told.drive.imposed, *told.drive.locked}
    names = [model.joint(i).name for i in single_joints(model)]
    names = [name for name in names if name not in known]
    if not names:
        return {}
    signals, compared = dict(told.signals), dict(told.compare)
    for name in names:
        for of, unit in zip(("position", "speed"), joint_units(model, name), strict=True):
            signals[f"{of} of {name}"] = Column(columns=(f"{of} of {name}",), unit=unit)
            compared[f"{of} of {name}"] = Compared(joint=name, of=of)  # type: ignore[arg-type]
    seen = replace(
        rig, description=told.model_copy(update={"signals": signals, "compare": compared})
    )
    forward = MjcfForward.of(seen)
    rows = forward.simulate(Excitation.of(recording, forward.drive), {})
    moved = dict(zip([channel.signal for channel in forward.channels], rows.T, strict=True))
    found = {}
    for name in names:
        q, speed = moved[f"position of {name}"], moved[f"speed of {name}"]
        joint = model.joint(name)
        rest = float(model.qpos_spring[int(joint.qposadr[0])])
        effort = float(joint.stiffness[0]) * (q - rest) + float(joint.damping[0]) * speed
        most = max(typical(effort), _driven(rig, name, recording))
        sizes = {"effort": most, "speed": typical(speed), "travel": travel(q)}
        found[name] = {k: v for k, v in sizes.items() if np.isfinite(v) and v > 0.0}
    return {name: sizes for name, sizes in found.items() if sizes}


def _driven(rig: Rig, joint: str, recording: Recording) -> float:
    """Typical effort of the motors of a joint whose commands are fed in; 0 without any."""
    model, found = rig.model, 0.0
    for name, signal in rig.description.drive.actuators.items():
        drive = model.actuator(name)
        if driven_joint(model, name) == joint and is_motor(model, int(drive.id)):
            gain = abs(float(drive.gear[0] * drive.gainprm[0]))
            found = max(found, gain * typical(recording[signal][:, 0]))
    return found
