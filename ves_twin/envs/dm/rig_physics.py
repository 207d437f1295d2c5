"""RigPhysics: dm_control's Physics over the live model and data of an environment's rig."""

from __future__ import annotations

from typing import Any, final

import gymnasium as gym
import numpy as np
from dm_control import mujoco
from dm_control.mujoco import wrapper

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.envs.rig_env import rig_env
from ves_twin.envs.task_env import Observation


@final
class RigPhysics(mujoco.Physics):  # type: ignore[misc]
    """Named access, rendering and state of the rig itself; a step is a step of the environment.

    Valves, computers and noise run between two steps of the mechanics, so the control that it
    takes is the action of the task, not `data.ctrl`, and it advances by whole steps of the task.
    What is written to `data` or `named.data` is written to the rig.

    A copy, also by pickle, is a plain `mujoco.Physics` of the mechanics at that instant.

    Attributes:
        observation: of the last step (m,).
        reward: of the last step.
        terminated: whether a safety stop ended the episode.
        truncated: whether its time did.
        info: of the last step, as Gymnasium's.

    Args:
        env: an environment of this room, with any wrappers.
        seed: of the first episode; later ones go on from it.
    """

    observation: Observation
    info: dict[str, Any]

    def __init__(self, env: gym.Env[Any, Any], seed: int | None = None) -> None:
        self._env, self._rig_env, self._seed = env, rig_env(env), seed
        self.observation, self.info = env.reset(seed=seed)
        self.reward, self.terminated, self.truncated = 0.0, False, False
        self._action = np.zeros(self._rig_env.actions.width)
        self._begun = False
        super().__init__(wrapper.MjData(self._rig_env.sim.data))

    @property
    def steps(self) -> int:
        """Ticks in a step of the environment."""
        return round(self._rig_env.span / self.timestep())

    def set_control(self, control: FloatArray) -> None:
        """The action of the next step, shares from -1 to 1 (n,)."""
        self._action = np.array(control, float)

    def step(self, nstep: int | None = None) -> None:
        """Advance the rig by a step of the environment.

        Args:
            nstep: its ticks, or nothing.

        Raises:
            InvalidInputError: another number of ticks, or an episode that is over.
        """
        if nstep not in (None, self.steps):
            raise InvalidInputError("nstep", nstep, f"{self.steps}, the ticks of a step")
        self.observation, reward, self.terminated, self.truncated, self.info = self._env.step(
            self._action
        )
        self.reward = float(reward)

    def reset(self, keyframe_id: int | None = None) -> None:
        """Begin an episode.

        Raises:
            InvalidInputError: a key frame; the rig has none.
        """
        if keyframe_id is not None:
            raise InvalidInputError("keyframe_id", keyframe_id, "None; an episode begins settled")
        seed = None if self._begun else self._seed
        self._begun = True
        self.observation, self.info = self._env.reset(seed=seed)
        self.reward, self.terminated, self.truncated = 0.0, False, False
        data = self._rig_env.sim.data
        if data is not self.data.ptr:
            self._reload_from_data(wrapper.MjData(data))

    def after_reset(self) -> None:
        """Nothing: the rig stands, and a forward pass would change the solver's warm start."""

    def time(self) -> float:
        """Time since the episode began [s]."""
        return float(self._rig_env.sim.time)

    def timestep(self) -> float:
        """Length of a tick of the rig [s]."""
        return float(self._rig_env.sim.rig.clock.tick)

    def copy(self, share_model: bool = False) -> mujoco.Physics:
        """The mechanics at this instant, apart from the rig."""
        return mujoco.Physics(self.data._make_copy(share_model=share_model))  # noqa: SLF001

    def __reduce__(self) -> tuple[type, tuple[Any]]:
        return mujoco.Physics, (self.data.copy(),)

    def close(self) -> None:
        """Free the renderer and close the environment."""
        self.free()
        self._env.close()
