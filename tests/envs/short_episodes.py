"""Environments on the fast rig with episodes of a second; those without a rig with one experiment."""

from __future__ import annotations

import gymnasium as gym
from gymnasium.envs.registration import load_env_creator

from ves_twin.envs import ENVIRONMENTS, RIG_ENVIRONMENTS
from ves_twin.scenario.schema import Scenario

SHORT = {"run.duration": 1.0, "run.settle": 0.5}


def short(name: str, **changes: object) -> Scenario:
    """A scenario of an environment, one second long."""
    return Scenario.load(name, {**SHORT, **changes})


def make_short(identity: str, plant: str = "ves2_fast", **options: object) -> gym.Env:
    """An environment by its id."""
    if identity not in RIG_ENVIRONMENTS:
        return gym.make(identity, experiments=1, **options)
    name = load_env_creator(ENVIRONMENTS[identity]).SCENARIO
    return gym.make(identity, plant=plant, scenario=short(name), **options)
