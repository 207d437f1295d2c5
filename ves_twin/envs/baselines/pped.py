"""Pped: the joint gains of thesis 4.3.2, made by moving the set-points of a stiff servo."""

from __future__ import annotations

from typing import final

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.envs.policy import Policy, TaskSpec
from ves_twin.mechanics.planning.flexible_base import PPED_GAINS
from ves_twin.plant.puma_chain import puma_chain

PARTS = 20
"""Euler steps in a step of the environment: B over H_qq is below 40 /s."""


@final
class Pped(Policy):
    """Joints that give way like springs and dampers: admittance control of the arm.

        H_qq q'' + B q' + K (q - q0) = -H_bq' P''

    with the base's motion P from the leg lengths. Integrated once it needs P' alone:
    p' = -B q' - K (q - q0),  q' = H_qq^-1 (p - H_bq' P').
    """

    def __init__(self, briefing: TaskSpec) -> None:
        q = np.array(briefing.scenario.arm.start)
        mass = puma_chain(briefing.belief).mass_matrix(q)
        self._coupling = mass[:6, 6:].T
        self._inverse = np.linalg.inv(mass[6:, 6:])
        self._briefing, self._scale = briefing, briefing.actions.high

    @classmethod
    def build(cls, briefing: TaskSpec) -> Pped:
        """For an environment of the arm on a base."""
        if "arm.rate" not in briefing.actions.slices or briefing.emulated is None:
            raise InvalidInputError("Pped", "no emulated base", "VesTwin/VibrationDamping-v0")
        return cls(briefing)

    def begin(self, observation: FloatArray) -> None:
        """At rest at the first angles."""
        seen = self._briefing.observations.split(observation)
        self._pose = seen["platform.pose"].copy()
        self._swing, self._momentum = np.zeros(3), np.zeros(3)

    def act(self, observation: FloatArray) -> FloatArray:
        """The rate that the soft joints have by now."""
        pose = self._briefing.observations.split(observation)["platform.pose"]
        h = self._briefing.step
        carried = self._coupling @ ((pose - self._pose) / h)
        self._pose = pose.copy()
        rate = np.zeros(3)
        for _ in range(PARTS):
            rate = self._inverse @ (self._momentum - carried)
            force = PPED_GAINS.damping * rate + PPED_GAINS.stiffness * self._swing
            self._momentum = self._momentum - h / PARTS * force
            self._swing = self._swing + h / PARTS * rate
        return np.asarray(np.clip(rate / self._scale, -1.0, 1.0))
