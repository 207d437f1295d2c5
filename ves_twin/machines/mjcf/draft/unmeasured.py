"""unmeasured: typical sizes of joints that no column tells, as the model moves them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ves_twin.core.recording.recording import Recording
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.machines.mjcf.draft.estimates import travel, typical
from ves_twin.machines.mjcf.draft.spots import single_joints
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.parts.joint_units import joint_units
from ves_twin.machines.mjcf.rig.column import Column
from ves_twin.machines.mjcf.rig.description import Compared
from ves_twin.machines.mjcf.rig.machine import Rig


def unmeasured(rig: Rig, recording: Recording) -> dict[str, dict[str, float]]:
    """Effort, speed and travel of joints without a column, along the motion that a model makes.

    The effort is that of the joint's own spring and damper, k (q - q0) + d dq, the only ones that
    a joint without an actuator has in the model.

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
        sizes = {"effort": typical(effort), "speed": typical(speed), "travel": travel(q)}
        found[name] = {k: v for k, v in sizes.items() if np.isfinite(v) and v > 0.0}
    return {name: sizes for name, sizes in found.items() if sizes}
