"""Train the network of the baseline `trained` by soft actor-critic (stable-baselines3).

Needs the extra `train`. Writes models/policies/damping_sac.npz, whose layers
`ves_twin.envs.baselines.trained` runs without torch, with its actions smoothed. The score is made
by `ves-twin evaluate VibrationDamping-v0 --policy trained --seeds 20`.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import gymnasium as gym
import numpy as np
import torch
from stable_baselines3 import SAC
from stable_baselines3.common.callbacks import BaseCallback

from ves_twin.envs.baselines.arm_features import ArmFeatures
from ves_twin.envs.rig_env import rig_env
from ves_twin.envs.wrappers import RandomRigs

LOSS = 10.0
"""Reward of a joule lost over a second, in place of 1: steps then have rewards of size one."""

EVERY = 20
"""Episodes between two lines of print."""

HIDDEN = (64, 64)


class Shown(gym.ObservationWrapper):
    """Features in place of readings, and rewards of size one."""

    def __init__(self, env: gym.Env) -> None:
        super().__init__(env)
        self._features = ArmFeatures(rig_env(env).briefing())
        self.observation_space = gym.spaces.Box(-np.inf, np.inf, (ArmFeatures.WIDTH,), np.float32)
        self.action_space = gym.spaces.Box(-1.0, 1.0, env.action_space.shape, np.float32)

    def reset(self, **options):
        seen, info = self.env.reset(**options)
        self._features.begin(seen)
        return self.observation(seen), info

    def step(self, action):
        seen, reward, terminated, truncated, info = self.env.step(action.astype(float))
        return self.observation(seen), LOSS * reward, terminated, truncated, info

    def observation(self, observation):
        return self._features.of(observation).astype(np.float32)


class Progress(BaseCallback):
    """Prints how it goes."""

    def __init__(self) -> None:
        super().__init__()
        self._returns: list[float] = []

    def _on_step(self) -> bool:
        for info in self.locals["infos"]:
            if "metrics" in info:
                self._returns.append(info["metrics"]["return"])
                if len(self._returns) % EVERY == 0:
                    middle = np.median(self._returns[-EVERY:])
                    print(
                        f"{len(self._returns):5d} episodes, {self.num_timesteps:7d} steps,"
                        f" {time.process_time():6.0f} s: median return {middle:7.2f}",
                        flush=True,
                    )
        return True


def save_layers(model: SAC, path: Path) -> None:
    """The actor's mean as plain layers: weight1, bias1, ..."""
    actor = model.policy.actor
    linear = [m for m in (*actor.latent_pi, actor.mu) if isinstance(m, torch.nn.Linear)]
    layers = {}
    for k, layer in enumerate(linear, 1):
        layers[f"weight{k}"] = layer.weight.detach().numpy().astype(np.float32)
        layers[f"bias{k}"] = layer.bias.detach().numpy().astype(np.float32)
    np.savez(path, **layers)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("models/policies/damping_sac.npz"))
    parser.add_argument("--steps", type=int, default=52_640, help="of the environment")
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    torch.set_num_threads(1)
    env = gym.make("VesTwin/VibrationDamping-v0", plant="ves2_fast", disable_env_checker=True)
    env = Shown(RandomRigs(env, "train-v0"))
    model = SAC(
        "MlpPolicy",
        env,
        seed=given.seed,
        device="cpu",
        learning_rate=7e-4,
        gamma=0.98,
        batch_size=256,
        train_freq=4,
        gradient_steps=2,
        learning_starts=4000,
        ent_coef="auto_0.1",
        policy_kwargs={"net_arch": list(HIDDEN)},
    )
    model.learn(total_timesteps=given.steps, callback=Progress())
    save_layers(model, given.out)


if __name__ == "__main__":
    main()
