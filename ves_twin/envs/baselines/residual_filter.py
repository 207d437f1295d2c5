"""ResidualFilter: the weight of an unknown tool from what the sensor reads beyond the estimate."""

from __future__ import annotations

from typing import final

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.envs.policy import Policy, TaskSpec
from ves_twin.mechanics.gravity.gravity_model import gravity_in_top
from ves_twin.mechanics.kinematics.wrenches import top_to_sensor

MEMORY = 3.0
"""Time over which mass and first moment are averaged [s]; the base swings at some 0.5 Hz."""


@final
class ResidualFilter(Policy):
    """Least squares with forgetting of a point mass at the tip on reading less estimate.

    The residual is m [g; p x g] with p the tip of the believed arm; inertial forces of the moving
    base and arm count as noise, which averages out. The correction is the weight of that mass.
    """

    def __init__(self, briefing: TaskSpec) -> None:
        if "gravity.correction" not in briefing.actions.slices:
            what = "VesTwin/GravityCompensation-v0"
            raise InvalidInputError("ResidualFilter", "no gravity correction", what)
        self._known, self._belief = briefing, briefing.belief
        self._sensor = briefing.belief.parameters.array("sensor.position")
        self._scale = briefing.actions.high
        self._keep = float(np.exp(-briefing.step / MEMORY))

    def begin(self, observation: FloatArray) -> None:
        """No tool, as sure of it as one reading of 1 N makes."""
        self._normal, self._right = 1.0, 0.0

    def act(self, observation: FloatArray) -> FloatArray:
        """The weight of the tool as far as it is known."""
        seen = self._known.observations.split(observation)
        unit = self._unit_weight(seen["platform.pose"], seen["arm.q"])
        left = seen["sensor.wrench"] - seen["gravity.estimate"] + seen["gravity.correction"]
        self._normal = self._keep * self._normal + float(unit @ unit)
        self._right = self._keep * self._right + float(unit @ left)
        mass = self._right / self._normal
        return np.asarray(np.clip(mass * unit / self._scale, -1.0, 1.0))

    def _unit_weight(self, pose: FloatArray, q: FloatArray) -> FloatArray:
        """Wrench of a kilogram at the tip, sensor axes [N, N m] (6,)."""
        tip = self._belief.arm.transforms(q)[2][:3, 3]
        force = gravity_in_top(pose[None, 3:], self._belief.parameters.number("gravity"))[0]
        return top_to_sensor(np.concatenate([force, np.cross(tip, force)]), self._sensor)
