"""VibrationDamping: after a release, damp the flexible base by moving the arm."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar, final

import numpy as np
from pydantic import TypeAdapter, ValidationError

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.envs.arm_env import ArmEnv, time_left
from ves_twin.envs.channels import Channels
from ves_twin.scenario.fields import Pose
from ves_twin.scenario.schema import Scenario


@final
class VibrationDamping(ArmEnv):
    """Reward: minus the strain energy in the base, integrated over the step [J s].

    The base is released from the scenario's start pose with signs of X, Y and Z drawn for each
    episode, or from `options={"goal": pose}`. Source: thesis 4.3.2 (release from 0.1, 0.1, 0.1 m).
    """

    SCENARIO: ClassVar[str] = "vibration_damping"
    WORST: ClassVar[float] = 100.0

    def channels(self, scenario: Scenario) -> tuple[Channels, Channels]:
        """The arm's channels and the time left."""
        observed, actions = self.arm_channels(scenario)
        return Channels(*observed, time_left(scenario)), actions

    def draw(self, scenario: Scenario, goal: object) -> tuple[Scenario, object]:
        """The pose of the release, as the scenario's start.

        Raises:
            InvalidInputError: a pose that is not six numbers.
        """
        if goal is None:
            signs = np.concatenate([self.np_random.choice([-1.0, 1.0], 3), np.ones(3)])
            pose = tuple(float(v) for v in signs * np.array(scenario.platform.start))
        else:
            given = goal.tolist() if isinstance(goal, np.ndarray) else goal
            try:
                pose = TypeAdapter(Pose).validate_python(given)
            except ValidationError:
                raise InvalidInputError("goal", given, "a pose of six numbers") from None
        platform = scenario.platform.model_copy(update={"start": pose})
        return scenario.model_copy(update={"platform": platform}), None

    def loss(self, poses: FloatArray, arm_q: FloatArray, times: Sequence[float]) -> float:
        """Strain energies [J]."""
        return self.strain(poses)
