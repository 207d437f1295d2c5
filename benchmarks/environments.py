"""Environment steps against bare mj_step on the same model, interleaved in one process.

Run by `make bench`. Prints the median over rounds of (processor time of bare mj_step) / (that of
env.step over as many ticks).
"""

from __future__ import annotations

import argparse
import copy
import os
import statistics
import subprocess
import sys
from time import perf_counter, process_time

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import gymnasium as gym
import mujoco
import numpy as np

from ves_twin.envs import RIG_ENVIRONMENTS
from ves_twin.envs.rig_env import CYCLES

STEPS = 10
"""Environment steps between two changes from the one to the other."""

PIECES = 8
"""Pieces of a round."""


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


FIRST = """if True:
    from time import process_time as clock
    begin = clock()
    import gymnasium as gym
    env = gym.make("ves_twin.envs:VesTwin/VibrationDamping-v0")
    middle = clock()
    env.reset(seed=0)
    print(f"{middle - begin:.2f} s until it is made, {clock() - middle:.2f} s first reset")
"""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=12)
    given = parser.parse_args()
    print("a process of its own, processor time: ", end="", flush=True)
    subprocess.run([sys.executable, "-c", FIRST], check=True)
    print("environment                       plant       ratio   5 %    95 %  steps/s")
    for name in RIG_ENVIRONMENTS:
        for plant in ("ves2", "ves2_fast"):
            found, speed = ratios(name, plant, given.rounds)
            cuts = statistics.quantiles(found, n=20)
            print(
                f"{name:<34}{plant:<10}{statistics.median(found):7.3f}{cuts[0]:7.3f}{cuts[-1]:8.3f}"
                f"{speed:9.0f}",
                flush=True,
            )


if __name__ == "__main__":
    main()
