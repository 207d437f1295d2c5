"""VibrationFreeReach: bring the arm to a goal with least strain energy in its flexible base."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import ClassVar, final

import numpy as np
from pydantic import TypeAdapter, ValidationError

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.envs.arm_env import JOINT_UNITS, ArmEnv, time_left
from ves_twin.envs.channels import Channel, Channels
from ves_twin.scenario.fields import Joints
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.signal_bus import SignalBus

ENERGY = 0.1
"""Strain energy that costs as much as a radian from the goal [J]: about the peak of the planned
and of the straight path of docs/planning.md."""

GOALS = np.radians([[45.0, -10.0, -30.0], [110.0, 60.0, 30.0]])
"""Corners of the box that goals are drawn from [rad]."""


@final
class VibrationFreeReach(ArmEnv):
    """Reward per second: -(strain energy / 0.1 J + distance to the goal / 1 rad).

    The distance is the Euclidean one of the true joint angles. A goal is drawn for each episode,
    or given as `options={"goal": [q1, q2, q3]}` in rad or as texts with units.
    """

    SCENARIO: ClassVar[str] = "vibration_free_reach"
    WORST: ClassVar[float] = 10.0

    def channels(self, scenario: Scenario) -> tuple[Channels, Channels]:
        """The arm's channels, the goal, the time left."""
        observed, actions = self.arm_channels(scenario)
        goal = Channel.within("goal", JOINT_UNITS, np.pi, "joint angles to reach")
        return Channels(*observed, goal, time_left(scenario)), actions

    def draw(self, scenario: Scenario, goal: object) -> tuple[Scenario, object]:
        """A goal in the box of GOALS.

        Raises:
            InvalidInputError: a goal that is not three angles within half a turn.
        """
        if goal is None:
            return scenario, self.np_random.uniform(*GOALS)
        given = goal.tolist() if isinstance(goal, np.ndarray) else goal
        try:
            angles = np.array(TypeAdapter(Joints).validate_python(given))
        except ValidationError:
            raise InvalidInputError("goal", given, "three joint angles") from None
        if np.any(np.abs(angles) > np.pi):
            raise InvalidInputError("goal", given, "angles within half a turn")
        return scenario, angles

    def start(self, goal: FloatArray) -> None:
        """Begin with a goal [rad] (3,)."""
        super().start(goal)
        self._goal, self._away = goal, 0.0

    def loss(self, poses: FloatArray, arm_q: FloatArray, times: Sequence[float]) -> float:
        """Energies and distances."""
        away = [math.dist(angles, self._goal) for angles in arm_q.tolist()]
        self._away = away[-1]
        return self.strain(poses) / ENERGY + sum(away)

    def readings(self, board: SignalBus) -> dict[str, FloatArray]:
        """Measurements, set-points, goal."""
        return {**super().readings(board), "goal": self._goal}

    def metrics(self) -> dict[str, float]:
        """The energy's, and the distance that is left [rad]."""
        return {**super().metrics(), "goal_error": self._away}
