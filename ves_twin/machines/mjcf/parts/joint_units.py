"""joint_units: units of a joint's position and speed."""

from __future__ import annotations

import mujoco

HINGE = int(mujoco.mjtJoint.mjJNT_HINGE)


def joint_units(model: mujoco.MjModel, joint: str) -> tuple[str, str]:
    """Of position and speed, SI, by whether a joint turns."""
    turns = int(model.jnt_type[model.joint(joint).id]) == HINGE
    return ("rad", "rad/s") if turns else ("m", "m/s")
