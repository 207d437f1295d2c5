"""RigTask: what a task of dm_control asks of an environment's rig, and what it is told."""

from __future__ import annotations

from collections import OrderedDict
from typing import final

import numpy as np
from dm_control.rl import control
from dm_env import specs

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.envs.channels import Channels
from ves_twin.envs.dm.rig_physics import RigPhysics


@final
class RigTask(control.Task):  # type: ignore[misc]
    """Observations by name in their units; a safety stop has discount 0, the end of time 1.

    Args:
        observations: the table of the observation's columns.
        actions: the table of the action's columns.
        flat: whether observations are flattened, so that their bounds are not told by name.
    """

    def __init__(self, observations: Channels, actions: Channels, flat: bool = False) -> None:
        self._observations, self._actions, self._flat = observations, actions, flat

    def initialize_episode(self, physics: RigPhysics) -> None:
        """Nothing: `RigPhysics.reset` began it."""

    def before_step(self, action: FloatArray, physics: RigPhysics) -> None:
        """Hand the action to the rig."""
        physics.set_control(action)

    def get_observation(self, physics: RigPhysics) -> OrderedDict[str, FloatArray]:
        """Readings by name, in their units."""
        return OrderedDict(self._observations.split(np.asarray(physics.observation, float)))

    def get_reward(self, physics: RigPhysics) -> float:
        """Minus the loss of the step, as Gymnasium's; it is not within 0 to 1."""
        return physics.reward

    def get_termination(self, physics: RigPhysics) -> float | None:
        """0 after a safety stop, 1 at the end of time."""
        if physics.terminated:
            return 0.0
        return 1.0 if physics.truncated else None

    def action_spec(self, physics: RigPhysics) -> specs.BoundedArray:
        """Shares from -1 to 1."""
        name = "\t".join(self._actions.columns)
        return specs.BoundedArray((self._actions.width,), np.float64, -1.0, 1.0, name)

    def observation_spec(self, physics: RigPhysics) -> OrderedDict[str, specs.BoundedArray]:
        """Bounds of each channel in its unit."""
        if self._flat:
            raise NotImplementedError  # control.Environment then infers the flat one
        return OrderedDict(
            (c.name, specs.BoundedArray((c.width,), np.float64, c.low, c.high, c.name))
            for c in self._observations.channels
        )

    @property
    def visualize_reward(self) -> bool:
        """Never: the rig keeps its colours."""
        return False

    @visualize_reward.setter
    def visualize_reward(self, value: bool) -> None:
        if value:
            raise InvalidInputError("visualize_reward", value, "False; the rig keeps its colours")
