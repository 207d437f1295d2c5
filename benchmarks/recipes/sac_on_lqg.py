"""Stable-Baselines3: soft actor-critic corrects LQG on VibrationDamping, and is held against it.

Needs the extra `train`. The network adds to the action of the linear controller, whose estimator is
told the sum; so it begins where LQG ends.

    python benchmarks/recipes/sac_on_lqg.py
    ves-twin evaluate VibrationDamping-v0 --policy benchmarks/recipes/sac_on_lqg.py:Learned

Source: Johannink et al., Residual reinforcement learning for robot control, ICRA 2019.
"""

from __future__ import annotations

import argparse
import time

import gymnasium as gym
import numpy as np
import torch
from stable_baselines3 import SAC
from stable_baselines3.common.callbacks import BaseCallback

from ves_twin.envs.baselines.arm_features import ArmFeatures
from ves_twin.envs.baselines.lqg import Lqg
from ves_twin.envs.evaluation import run_episode
from ves_twin.envs.policy import Policy
from ves_twin.envs.rig_env import rig_env
from ves_twin.envs.wrappers import RandomRigs

KEEP, REACH = 0.5, 0.5
"""Share of the last correction in the next one; largest correction in shares of the scale."""

LOSS, COST, DEAREST = 10.0, 0.1, 3.0
"""Reward of a joule lost over a second in place of 1, so that steps have rewards of size one; that
of a step with a cost of 1; cost from which it stays the same."""

CHECKED = range(1000, 1008)
"""Seeds of the evaluations."""

WIDTH = ArmFeatures.WIDTH + 6

NETWORK = "runs/sac_on_lqg.zip"
"""Where a training ends, and where an evaluation finds it."""


class Corrected(Lqg):
    """Action of Lqg plus REACH d, with d = KEEP d_last + (1 - KEEP) times what a network says.

    Shown are the features of `ArmFeatures`, the action of Lqg, and d_last: WIDTH numbers.
    """

    def begin(self, observation):
        super().begin(observation)
        self._features = ArmFeatures(self._known)
        self._features.begin(observation)
        self._added = np.zeros(3)

    def see(self, observation):
        self._wanted = self.decide(self.estimate(observation))
        shown = [self._features.of(observation), self._wanted, self._added]
        return np.concatenate(shown).astype(np.float32)

    def correct(self, said):
        self._added = KEEP * self._added + (1.0 - KEEP) * said
        action = np.clip(self._wanted + REACH * self._added, -1.0, 1.0)
        self.expect(action)
        return action


class Correction(gym.Wrapper):
    """An environment whose actions are corrections."""

    def __init__(self, env: gym.Env) -> None:
        super().__init__(env)
        self._policy = Corrected(rig_env(env).briefing())
        self.observation_space = gym.spaces.Box(-np.inf, np.inf, (WIDTH,), np.float32)
        self.action_space = gym.spaces.Box(-1.0, 1.0, env.action_space.shape, np.float32)

    def reset(self, **options):
        seen, info = self.env.reset(**options)
        self._policy.begin(seen)
        return self._policy.see(seen), info

    def step(self, action):
        action = self._policy.correct(action.astype(float))
        seen, reward, terminated, truncated, info = self.env.step(action)
        reward = LOSS * reward - COST * min(info["cost"], DEAREST)
        return self._policy.see(seen), reward, terminated, truncated, info


class Learned(Policy):
    """A policy of this room from a model of Stable-Baselines3."""

    def __init__(self, briefing, model: SAC) -> None:
        self._policy, self._model = Corrected(briefing), model

    @classmethod
    def build(cls, briefing):
        return cls(briefing, SAC.load(NETWORK, device="cpu"))

    def begin(self, observation):
        self._policy.begin(observation)

    def act(self, observation):
        said, _ = self._model.predict(self._policy.see(observation), deterministic=True)
        return self._policy.correct(said.astype(float))


class Evaluated(BaseCallback):
    """Prints how the mean action does against Lqg, with the same rigs, releases and noise."""

    def __init__(self, env: gym.Env, every: int) -> None:
        super().__init__()
        self._env, self._every = env, every
        self._known = rig_env(env).briefing()
        rival = Lqg(self._known)
        self._rival = [run_episode(env, rival, seed) for seed in CHECKED]

    def _on_step(self) -> bool:
        if self.num_timesteps % self._every == 0:
            policy = Learned(self._known, self.model)
            found = [run_episode(self._env, policy, seed) for seed in CHECKED]
            more = [
                one.metrics["return"] - other.metrics["return"]
                for one, other in zip(found, self._rival, strict=True)
            ]
            cost = np.mean([one.cost for one in found])
            print(
                f"{self.num_timesteps:7d} steps, {time.process_time():5.0f} s:"
                f" return more than lqg {np.mean(more):+.2f}"
                f" ({min(more):+.2f} to {max(more):+.2f}), cost {cost:.2f}",
                flush=True,
            )
        return True


def rigs() -> gym.Env:
    """The quick rig, with another of train-v0 in every episode."""
    name = "ves_twin.envs:VesTwin/VibrationDamping-v0"
    return RandomRigs(gym.make(name, plant="ves2_fast", disable_env_checker=True), "train-v0")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--steps", type=int, default=72_000)
    parser.add_argument("--every", type=int, default=6_000, help="steps between evaluations")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", default=NETWORK)
    given = parser.parse_args()
    torch.set_num_threads(1)
    model = SAC(
        "MlpPolicy",
        Correction(rigs()),
        seed=given.seed,
        device="cpu",
        learning_rate=lambda left: 7e-4 * left + 5e-5,
        gamma=0.98,
        train_freq=4,
        gradient_steps=2,
        learning_starts=2000,
        ent_coef="auto_0.1",
        policy_kwargs={"net_arch": [64, 64]},
    )
    model.learn(given.steps, callback=Evaluated(rigs(), given.every))
    model.save(given.out)


if __name__ == "__main__":
    main()
