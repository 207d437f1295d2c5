"""InertialDamper: the arm accelerates with the velocity of the base, the classical damper."""

from __future__ import annotations

from typing import final

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.envs.policy import Policy, TaskSpec
from ves_twin.plant.puma_chain import puma_chain

GAIN = 2.0
"""Damping over the mass that the arm moves [1/s]; of 0.1 to 3 about the best on four rigs of
train-v0 (`fast`), where 3 gains one per cent more."""

SMALL = 0.1
"""Share of the strongest coupling below which a direction counts as none: with the arm stretched,
joints 2 and 3 push the same way."""

RETURN = 0.2
"""Rate at which the arm goes back to its start [1/s]."""


@final
class InertialDamper(Policy):
    """q' = GAIN H_tq# M P - RETURN (q - q0), with the place P of the base from home (3,).

    Its derivative q'' = GAIN H_tq# M P' puts the force -H_tq q'' = -GAIN M P' on the base: a
    damper. M is the payload's mass, H_tq the joints' coupling with the base's translation and #
    its pseudo-inverse; with the rotations as well three joints have more to do than they can.
    """

    def __init__(self, briefing: TaskSpec) -> None:
        if "arm.rate" not in briefing.actions.slices or briefing.emulated is None:
            what = "VesTwin/VibrationDamping-v0"
            raise InvalidInputError("InertialDamper", "no arm on an emulated base", what)
        self._known = briefing
        self._home = np.array(briefing.scenario.platform.home)
        mass = puma_chain(briefing.belief).mass_matrix(np.array(briefing.scenario.arm.start))
        self._gain = GAIN * np.linalg.pinv(mass[:3, 6:], rcond=SMALL) @ mass[:3, :3]

    def begin(self, observation: FloatArray) -> None:
        """The set-points to come back to."""
        self._start = self._known.observations.split(observation)["arm.command"].copy()

    def act(self, observation: FloatArray) -> FloatArray:
        """Joint rates for the next step."""
        seen = self._known.observations.split(observation)
        away = (seen["platform.pose"] - self._home)[:3]
        rate = self._gain @ away - RETURN * (seen["arm.command"] - self._start)
        return np.asarray(np.clip(rate / self._known.actions.high, -1.0, 1.0))
