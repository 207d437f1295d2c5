"""Environment steps against bare mj_step on the same model, interleaved in one process.

Run by `make bench`. Prints the median over rounds of (processor time of bare mj_step) / (that of
env.step over as many ticks), and how many times one environment's steps eight of them make in
processes, by the clock on the wall.
"""

from __future__ import annotations

import argparse
import copy
import os
import statistics
from time import perf_counter, process_time

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import gymnasium as gym
import mujoco
import numpy as np

from ves_twin.envs import ENVIRONMENTS
from ves_twin.envs.rig_env import CYCLES

STEPS = 10
"""Environment steps between two changes from the one to the other."""

PIECES = 8
"""Pieces of a round."""

COPIES = 8
"""Environments side by side."""


def ratios(name: str, plant: str, rounds: int) -> tuple[list[float], float]:
    """Ratio of each round, and environment steps a second."""
    env = gym.make(name, plant=plant)
    action = np.zeros(env.action_space.shape)
    env.reset(seed=0)
    found, total = [], 0.0
    for _ in range(rounds):
        env.reset(seed=0)
        env.step(action)
        bare = whole = 0.0
        for _ in range(PIECES):
            sim = env.unwrapped.sim
            ticks = STEPS * CYCLES * sim.rig.clock.admittance
            data = copy.copy(sim.data)
            begin = process_time()
            mujoco.mj_step(sim.model, data, ticks)
            middle, clock = process_time(), perf_counter()
            for _ in range(STEPS):
                env.step(action)
            bare, whole = bare + middle - begin, whole + process_time() - middle
            total += perf_counter() - clock
        found.append(bare / whole)
    env.close()
    return found, rounds * PIECES * STEPS / total


def side_by_side(name: str, plant: str, steps: int) -> float:
    """Steps a second of COPIES environments in processes, all together."""
    envs = gym.make_vec(
        name,
        num_envs=COPIES,
        vectorization_mode="async",
        vector_kwargs={"context": "spawn"},
        plant=plant,
    )
    actions = np.zeros(envs.action_space.shape)
    envs.reset(seed=0)
    envs.step(actions)
    begin = perf_counter()
    for _ in range(steps):
        envs.step(actions)
    spent = perf_counter() - begin
    envs.close()
    return COPIES * steps / spent


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=12)
    parser.add_argument("--steps", type=int, default=200, help="of eight in processes; 0 for none")
    given = parser.parse_args()
    print(
        "environment                       plant       ratio   5 %    95 %  steps/s  8 in processes"
    )
    for name in ENVIRONMENTS:
        for plant in ("ves2", "ves2_fast"):
            found, speed = ratios(name, plant, given.rounds)
            cuts = statistics.quantiles(found, n=20)
            together = side_by_side(name, plant, given.steps) if given.steps else np.nan
            print(
                f"{name:<34}{plant:<10}{statistics.median(found):7.3f}{cuts[0]:7.3f}{cuts[-1]:8.3f}"
                f"{speed:9.0f}{together / speed:10.2f} x",
                flush=True,
            )


if __name__ == "__main__":
    main()
