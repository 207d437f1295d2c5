"""Environment steps against bare mj_step on the same model, interleaved in one process.

Run by `make bench`. Prints the median over rounds of (processor time of bare mj_step) / (that of
env.step over as many ticks), and what a step could be at best: the compiled loop without the
engine, the noise, and what an aim leaves for all that is Python.
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
from ves_twin.simulator.engine import NO_CALL, address_of
from ves_twin.simulator.loop import run_ticks
from ves_twin.simulator.noise import BLOCK, _draw

AIMS = {"ves2": 0.95, "ves2_fast": 0.85}
"""Share of bare mj_step that is asked."""

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


def best(plant: str, rounds: int) -> str:
    """Times of a tick [us] of engine, compiled loop and noise; what they leave of an aim."""
    env = gym.make("VesTwin/VibrationDamping-v0", plant=plant)
    env.reset(seed=0)
    env.step(np.zeros(env.action_space.shape))
    sim = env.unwrapped.sim
    rig, start = sim.rig, sim.rig.snapshot()
    ticks = CYCLES * rig.clock.admittance
    idle = address_of("mj_version")  # a function that does nothing
    (_, following, *handles), arrays = rig._engine, rig._arrays  # noqa: SLF001  (no public names)
    engine = idle, NO_CALL if following == NO_CALL else idle, *handles
    blocks = rig.board.block, rig.board.row
    times = np.empty((rounds, 3))
    for k, row in enumerate(times):
        rig.restore(start)
        data, normal = copy.copy(rig.data), rig.noise.window(rig.tick, ticks)
        begin = process_time()
        mujoco.mj_step(rig.model, data, ticks)
        stepped = process_time()
        run_ticks(
            rig.tick, ticks, *engine, *arrays, rig.parameters, rig.state, *blocks, *normal,
            sim.recorder.log, 0,
        )  # fmt: skip
        looped = process_time()
        _draw(0, k)
        drawn = (process_time() - looped) * ticks / BLOCK
        row[:] = stepped - begin, looped - stepped, drawn
    env.close()
    mechanics, loop, noise = 1e6 * np.median(times, axis=0)
    left = mechanics / AIMS[plant] - mechanics - loop - noise
    share = mechanics / (mechanics + loop + noise)
    return (
        f"{plant}: a tick of mj_step {mechanics / ticks:.2f} us, of the loop {loop / ticks:.2f},"
        f" of the noise {noise / ticks:.2f}; without Python {share:.3f};"
        f" {AIMS[plant]} leaves a step {left:.0f} us of Python"
    )


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
    for plant in AIMS:
        print(best(plant, 10 * given.rounds), flush=True)
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
