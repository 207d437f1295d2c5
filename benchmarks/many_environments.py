"""Eight environments on all cores against one, beside what two processes gain at bare mj_step.

Run by `make bench`. Rounds in turn: one environment here, eight by `ChunkedVectorEnv`, eight by
Gymnasium's `AsyncVectorEnv`, bare mj_step in one process and in all. Prints medians over rounds of
steps a second by the clock on the wall over those of one, and processor time of a step with all
processes counted.
"""

from __future__ import annotations

import argparse
import copy
import multiprocessing
import os
import statistics
from collections.abc import Callable
from pathlib import Path
from time import perf_counter

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import gymnasium as gym
import mujoco
import numpy as np

from ves_twin.envs import RIG_ENVIRONMENTS
from ves_twin.envs.chunked_vector_env import ChunkedVectorEnv
from ves_twin.envs.rig_env import CYCLES

COPIES = 8
"""Environments side by side."""

CORES = os.cpu_count() or 1

STEPS = {"ves2": 25, "ves2_fast": 75}
"""Steps of each of the eight in a round: half a second to a second."""


def processor_time(processes: list[int]) -> float:
    """What the threads of some processes have used [s]; Linux alone tells it for others."""
    tasks = [task for pid in processes for task in Path(f"/proc/{pid}/task").glob("*/schedstat")]
    return 1e-9 * sum(int(task.read_text().split()[0]) for task in tasks)


def spent(work: Callable[[], None], processes: list[int]) -> tuple[float, float]:
    """Seconds by the clock, and of the processor in some processes, that something takes."""
    begin, used = perf_counter(), processor_time(processes)
    work()
    return perf_counter() - begin, processor_time(processes) - used


def stepped(env: gym.Env, actions: np.ndarray, count: int) -> None:
    for _ in range(count):
        *_, terminated, truncated, _ = env.step(actions)
        if terminated or truncated:
            env.reset()


def bare(name: str, plant: str, pipe: multiprocessing.connection.Connection) -> None:
    """A process that does bare mj_step for as many steps as its pipe says, from one state on."""
    env = gym.make(name, plant=plant)
    env.reset(seed=0)
    env.step(np.zeros(env.action_space.shape))
    sim = env.unwrapped.sim
    pipe.send(None)
    while (steps := pipe.recv()) is not None:
        data = copy.copy(sim.data)
        for _ in range(steps):
            mujoco.mj_step(sim.model, data, CYCLES * sim.rig.clock.admittance)
        pipe.send(None)


class Bare:
    """Processes of bare mj_step."""

    def __init__(self, name: str, plant: str) -> None:
        context = multiprocessing.get_context("spawn")
        self.pipes = []
        for _ in range(CORES):
            ours, theirs = context.Pipe()
            context.Process(target=bare, args=(name, plant, theirs), daemon=True).start()
            self.pipes.append(ours)
            ours.recv()

    def step(self, count: int, processes: int) -> None:
        for pipe in self.pipes[:processes]:
            pipe.send(count)
        for pipe in self.pipes[:processes]:
            pipe.recv()

    def close(self) -> None:
        for pipe in self.pipes:
            pipe.send(None)


def measure(name: str, plant: str, rounds: int) -> str:
    """A row of the table."""
    one = gym.make(name, plant=plant)
    shared = ChunkedVectorEnv(name, COPIES, plant=plant)
    own = gym.make_vec(
        name,
        num_envs=COPIES,
        vectorization_mode="async",
        vector_kwargs={"context": "spawn"},
        plant=plant,
    )
    mechanics = Bare(name, plant)
    steps, actions = STEPS[plant], np.zeros((COPIES, *one.action_space.shape))
    for env in (one, shared, own):
        env.reset(seed=0)
    stepped(one, actions[0], 2)
    here = os.getpid()
    work: dict[str, tuple[Callable[[], None], list[int], int]] = {
        "one": (lambda: stepped(one, actions[0], 2 * steps), [here], 2 * steps),
        "shared": (
            lambda: [shared.step(actions) for _ in range(steps)],
            [here],
            COPIES * steps,
        ),
        "async": (
            lambda: [own.step(actions) for _ in range(steps)],
            [here, *(p.pid for p in own.processes)],
            COPIES * steps,
        ),
        "bare one": (lambda: mechanics.step(2 * steps, 1), [here], 2 * steps),
        "bare all": (lambda: mechanics.step(2 * steps, CORES), [here], CORES * 2 * steps),
    }
    times: dict[str, list[tuple[float, float]]] = {key: [] for key in work}
    for _ in range(rounds):
        for key, (run, processes, count) in work.items():
            clock, used = spent(run, processes)
            times[key].append((clock / count, used / count))
    for env in (one, shared, own, mechanics):
        env.close()
    wall = {key: np.array([t[0] for t in found]) for key, found in times.items()}
    used = {key: 1e3 * statistics.median(t[1] for t in found) for key, found in times.items()}
    gains = {
        "shared": wall["one"] / wall["shared"],
        "async": wall["one"] / wall["async"],
        "bare": wall["bare one"] / wall["bare all"],
    }
    told = [f"{np.median(g):6.2f} ({g.min():.2f} to {g.max():.2f})" for g in gains.values()]
    busy = " ".join(f"{used[key]:6.3f}" for key in ("one", "shared", "async"))
    speed = f"{1.0 / np.median(wall['one']):5.0f}"
    return f"{name:<31}{plant:<10}{speed} {'  '.join(told)}  {busy}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=8)
    parser.add_argument("--names", nargs="+", default=RIG_ENVIRONMENTS, choices=RIG_ENVIRONMENTS)
    parser.add_argument("--plants", nargs="+", default=list(STEPS), choices=list(STEPS))
    given = parser.parse_args()
    print(f"{CORES} cores, load {os.getloadavg()[0]:.1f} before it began")
    print(
        f"{'environment':<31}{'plant':<9}{'one/s':>6} {'eight, ChunkedVectorEnv':>19}"
        f"{'eight, Async':>22}{f'bare, {CORES} processes':>23}   ms: one, shared, async"
    )
    for name in given.names:
        for plant in given.plants:
            print(measure(name, plant, given.rounds), flush=True)


if __name__ == "__main__":
    main()
