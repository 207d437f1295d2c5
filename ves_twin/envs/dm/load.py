"""load: an environment of dm_control by domain and task, as `dm_control.suite.load` does."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

import gymnasium as gym
import numpy as np
from dm_control.rl import control

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.envs import RIG_ENVIRONMENTS
from ves_twin.envs.dm.rig_physics import RigPhysics
from ves_twin.envs.dm.rig_task import RigTask
from ves_twin.envs.rig_env import rig_env

DOMAIN = "ves2"

OPTIONS = ("flat_observation",)
"""What `environment_kwargs` may hold; time and step are the task's own."""


def _task(identity: str) -> str:
    """An id as a task: VesTwin/VibrationDamping-v0 is vibration_damping; a -v1 stays as _v1."""
    name = identity.split("/")[1].removesuffix("-v0").replace("-", "_")
    return re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name).lower()


_IDS = {_task(identity): identity for identity in RIG_ENVIRONMENTS}

ALL_TASKS = tuple((DOMAIN, task) for task in _IDS)
"""(domain, task), as dm_control.suite has them."""

TASKS_BY_DOMAIN = {DOMAIN: tuple(_IDS)}


def load(
    domain_name: str,
    task_name: str,
    task_kwargs: Mapping[str, Any] | None = None,
    environment_kwargs: Mapping[str, Any] | None = None,
    visualize_reward: bool = False,
) -> control.Environment:
    """An environment whose Physics is the live rig; the episode is Gymnasium's to the last bit.

    Args:
        domain_name: "ves2".
        task_name: of ALL_TASKS, for instance "vibration_damping".
        task_kwargs: `random`, the seed of the first episode, and what `gym.make` takes: `plant`,
            `scenario`.
        environment_kwargs: `flat_observation`, as `control.Environment` takes it.
        visualize_reward: False.

    Raises:
        UnknownNameError: no such domain, task or option.
        VesTwinError: a plant or scenario that cannot be used.
    """
    if domain_name != DOMAIN:
        raise UnknownNameError("domain", domain_name, [DOMAIN])
    if task_name not in _IDS:
        raise UnknownNameError(f"task of {DOMAIN}", task_name, _IDS)
    for option in environment_kwargs or {}:
        if option not in OPTIONS:
            raise UnknownNameError("option of the environment", option, OPTIONS)
    given = dict(task_kwargs or {})
    seed = given.pop("random", None)
    env = gym.make(_IDS[task_name], disable_env_checker=True, **given)
    made = control_environment(env, seed, **(environment_kwargs or {}))
    made.task.visualize_reward = visualize_reward
    return made


def control_environment(
    env: gym.Env[Any, Any], random: int | None = None, flat_observation: bool = False
) -> control.Environment:
    """The same for an environment of this room that is made already, with any wrappers.

    The time limit is the environment's own.

    Args:
        env: the environment, not scaled.
        random: seed of the first episode; later ones go on from it.
        flat_observation: whether observations are one vector, "observations".

    Raises:
        InvalidInputError: a scaled environment, or one of another kind.
    """
    inner = rig_env(env)
    if env.observation_space.shape != (inner.observations.width,) or (
        env.observation_space.dtype != np.float64
    ):
        raise InvalidInputError("environment", "other observations", "one in physical units")
    physics = RigPhysics(env, random)
    task = RigTask(inner.observations, inner.actions, flat_observation)
    return control.Environment(
        physics, task, n_sub_steps=physics.steps, flat_observation=flat_observation
    )
