"""LagFeedforward: set-points ahead of the legs' lag, and an integrator on the measured lengths."""

from __future__ import annotations

from typing import final

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.envs.policy import Policy, TaskSpec

DELAY = 0.005
"""Delay beside the leg loop's own lag [s]: the valve's 4 ms and more; tuned on train-v0."""

PROPORTIONAL, INTEGRAL = 0.5, 5.0
"""Offset per length error [1], and its rate [1/s]; tuned on train-v0."""


@final
class LagFeedforward(Policy):
    """Offset = (1/gain + DELAY) l_ref' + P (l_ref - l) + I int (l_ref - l), leg by leg."""

    def __init__(self, briefing: TaskSpec) -> None:
        if "reference.ahead" not in briefing.observations.slices:
            raise InvalidInputError("LagFeedforward", "no reference", "VesTwin/PlatformTracking-v0")
        self._known = briefing
        self._geometry = briefing.belief.geometry
        self._home = self._geometry.lengths(np.zeros(6))
        self._lag = 1.0 / briefing.scenario.legs.gain + DELAY
        self._scale = briefing.actions.high

    def begin(self, observation: FloatArray) -> None:
        """Nothing summed up, legs at rest."""
        self._sum, self._before = np.zeros(6), np.zeros(6)

    def act(self, observation: FloatArray) -> FloatArray:
        """Offsets for the end of the step."""
        seen, h = self._known.observations.split(observation), self._known.step
        now = self._geometry.lengths(seen["reference.pose"])
        rate = (self._geometry.lengths(seen["reference.ahead"]) - now) / h
        at_end = 1.5 * rate - 0.5 * self._before
        self._before = rate
        error = now - self._home - seen["leg.travel"]
        self._sum = np.clip(self._sum + INTEGRAL * h * error, -self._scale, self._scale)
        offset = self._lag * at_end + PROPORTIONAL * error + self._sum
        return np.asarray(np.clip(offset / self._scale, -1.0, 1.0))
