"""drawn: an MJCF machine as bodies that its measured joint positions place."""

from __future__ import annotations

import mujoco
import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.machines.drawing import Columns, Drawing
from ves_twin.machines.mjcf.rig.machine import Rig

SCALAR = (mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE)


def drawn(rig: Rig) -> Drawing | None:
    """By every hinge and slide whose position is compared; None if there is none."""
    model, places = rig.model, dict[str, tuple[int, float]]()
    for name, told in rig.description.compare.items():
        if not told.joint or told.of != "position":
            continue
        joint = model.joint(told.joint).id
        if mujoco.mjtJoint(model.jnt_type[joint]) in SCALAR:
            places[name] = (int(model.jnt_qposadr[joint]), float(told.sign))
    if not places:
        return None

    def place(columns: Columns) -> FloatArray:
        rows = len(next(iter(columns.values())))
        qpos = np.tile(np.array(model.qpos0), (rows, 1))
        for name, (at, sign) in places.items():
            qpos[:, at] = sign * columns[name][:, 0]
        return qpos

    return Drawing(model, dict.fromkeys(places, 1), place)
