"""Chase: resolved-rate control of the tip towards a target that drifts."""

from __future__ import annotations

from typing import final

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.envs.capture import tip_jacobian, tip_position
from ves_twin.envs.policy import Policy, TaskSpec

GAIN = 1.0
"""Rate per distance [1/s]; a tenth of the base's and servo's bandwidth."""

DAMPING = 0.05
"""Of the inverse near stretched arms [m]."""


@final
class Chase(Policy):
    """q' = J# (v + GAIN (p - x) - x_b') with the tip x of the believed arm at the measured pose.

    J# = J' (J J' + DAMPING^2)^-1 is the damped inverse; x_b' is what the base alone does to the
    tip, by differences.

    Source: Nakamura and Hanafusa, ASME J. Dyn. Syst. 108, 1986 (damped least squares).
    """

    def __init__(self, briefing: TaskSpec) -> None:
        if "target.position" not in briefing.observations.slices:
            raise InvalidInputError("Chase", "no target", "VesTwin/MicrogravityCapture-v0")
        self._known = briefing

    def begin(self, observation: FloatArray) -> None:
        """The base is at rest."""
        self._pose = self._known.observations.split(observation)["platform.pose"].copy()

    def act(self, observation: FloatArray) -> FloatArray:
        """Joint rates for the next step."""
        seen, belief = self._known.observations.split(observation), self._known.belief
        pose, q = seen["platform.pose"], seen["arm.q"]
        tip = tip_position(belief, pose, q)
        carried = (tip - tip_position(belief, self._pose, q)) / self._known.step
        self._pose = pose.copy()
        jacobian = tip_jacobian(belief, pose, q)
        wanted = seen["target.velocity"] + GAIN * (seen["target.position"] - tip) - carried
        square = jacobian @ jacobian.T + DAMPING**2 * np.eye(3)
        rate = jacobian.T @ np.linalg.solve(square, wanted)
        return np.asarray(np.clip(rate / self._known.actions.high, -1.0, 1.0))
