"""StandingRig: the compiled rig placed at a pose, for what can be read off without a simulation."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.plant.assembly import assemble, compile_model
from ves_twin.plant.layout import Layout
from ves_twin.plant.plant import Plant
from ves_twin.plant.statics import place_rig
from ves_twin.simulator.truth_port import GravityTruth


@dataclass(frozen=True)
class StandingRig:
    """A model of the rig in MuJoCo, to be placed at poses.

    Attributes:
        plant: the rig.
        model: compiled model.
        data: its state.
        layout: where the rig's quantities lie in it.
    """

    plant: Plant
    model: mujoco.MjModel
    data: mujoco.MjData
    layout: Layout

    @staticmethod
    def of(plant: Plant) -> StandingRig:
        """The rig of a plant."""
        model = compile_model(assemble(plant, plant.parameters.number("clock.tick")))
        return StandingRig(plant, model, mujoco.MjData(model), Layout.of(model))

    @property
    def payload(self) -> float:
        """Mass of everything above the force sensor [kg]."""
        return float(self.model.body_subtreemass[self.layout.sensor_body])

    def gravity_in_sensor(self, pose: FloatArray, q: FloatArray) -> FloatArray:
        """Gravity wrench of the payload in sensor axes [N, N m] (6,).

        Args:
            pose: platform pose from home [m, rad] (6,).
            q: joint angles of the arm [rad] (3,).
        """
        place_rig(self.data, self.layout, self.plant.geometry, np.asarray(pose), np.asarray(q))
        mujoco.mj_forward(self.model, self.data)
        return GravityTruth(self.model, self.data, self.layout).gravity_in_sensor()
