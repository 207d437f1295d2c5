"""drawn: VES II as bodies that its leg lengths and joint angles place."""

from __future__ import annotations

from contextlib import suppress

import mujoco
import numpy as np

from ves_twin.core.errors import UnreachableError
from ves_twin.core.types import FloatArray
from ves_twin.machines.drawing import Columns, Drawing
from ves_twin.plant.assembly import assemble, compile_model
from ves_twin.plant.layout import Layout
from ves_twin.plant.plant import Plant
from ves_twin.plant.statics import place_rig

STEP = 1e-3
"""Physics step of the drawn model [s]; it is placed by kinematics and never stepped."""

LEGS, ARM = "leg.length", "arm.q"


def drawn(plant: Plant) -> Drawing:
    """With the legs of the full rig, straight: their bending is too small to see."""
    model = compile_model(assemble(plant.with_fidelity("full"), STEP))
    layout, geometry = Layout.of(model), plant.geometry
    data = mujoco.MjData(model)

    def place(columns: Columns) -> FloatArray:
        pose, found = np.zeros(6), []
        for lengths, q in zip(columns[LEGS], columns[ARM], strict=True):
            with suppress(UnreachableError):  # where a model goes too far it stays drawn
                pose = geometry.pose(lengths, pose)
            place_rig(data, layout, geometry, pose, q)
            found.append(data.qpos.copy())
        return np.array(found).reshape(-1, model.nq)

    return Drawing(model, {LEGS: 6, ARM: 3}, place)
