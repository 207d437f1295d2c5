"""Stable-Baselines3: soft actor-critic on VibrationDamping, eight environments at once.

Needs the extra `train`. `--steps` are of one environment each; the network is kept as a zip.
"""

from __future__ import annotations

import argparse

import gymnasium as gym
import torch
from stable_baselines3 import SAC
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.monitor import Monitor
from stable_baselines3.common.vec_env import DummyVecEnv

from ves_twin.envs.wrappers import RandomRigs


def make(rigs: str) -> gym.Env:
    """Scaled, on the quick rig, with another rig in every episode."""
    env = gym.make("ves_twin.envs:VesTwin/VibrationDamping-v0", plant="ves2_fast", scaled=True)
    return Monitor(RandomRigs(env, rigs))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--steps", type=int, default=100_000)
    parser.add_argument("--envs", type=int, default=8)
    parser.add_argument("--episodes", type=int, default=10, help="of the evaluation")
    parser.add_argument("--out", default="runs/sac_damping.zip")
    given = parser.parse_args()
    torch.set_num_threads(1)
    envs = DummyVecEnv([lambda: make("train-v0")] * given.envs)
    model = SAC("MlpPolicy", envs, seed=0, gamma=0.98, learning_starts=200, train_freq=4)
    model.learn(given.steps)
    model.save(given.out)
    mean, spread = evaluate_policy(model, make("test-v0"), given.episodes)
    print(f"return on test-v0: {mean:.2f} +- {spread:.2f}")


if __name__ == "__main__":
    main()
