"""home_of: what is added to a joint's position that is told from elsewhere than its zero."""

from __future__ import annotations

import mujoco
import numpy as np

from ves_twin.machines.mjcf.draft.estimates import travel
from ves_twin.machines.mjcf.draft.log_columns import LogColumns
from ves_twin.machines.mjcf.draft.match import Match

FIRST = 10
"""Rows that tell where a log begins."""


def home_of(position: Match, model: mujoco.MjModel, log: LogColumns) -> tuple[float, str] | None:
    """What makes a joint's position of a length that is told from elsewhere [its unit], and why.

    The length that a sliding part has in the model, if the log begins near it; else where it
    begins. None where the log begins near the joint's own zero.
    """
    values = position.factor * log.column(position.column)
    joint, near = model.joint(position.spot.name), 2.0 * travel(values)
    body, begin = int(joint.bodyid[0]), float(np.mean(values[:FIRST]))
    zero = float(model.qpos0[int(joint.qposadr[0])])
    if abs(begin - zero) < near:
        return None
    along = np.zeros(3)
    mujoco.mju_rotVecQuat(along, joint.axis, model.body_quat[body])
    length = abs(float(along @ model.body_pos[body]))
    unit = position.factor / position.scale
    slides = int(joint.type[0]) == int(mujoco.mjtJoint.mjJNT_SLIDE)
    if slides and abs(begin - length) < near:
        return (zero - length) / unit, "offset: the length that the model has at home"
    return (zero - begin) / unit, "offset: as if the log began where the model stands"
