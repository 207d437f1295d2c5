"""evaluate: a policy on the rigs of a set, an episode a seed; interquartile means, intervals."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from typing import Any

import gymnasium as gym
import numpy as np

from ves_twin.core.code_file import load_class
from ves_twin.core.errors import (
    ControllerError,
    InvalidInputError,
    UnknownNameError,
    VesTwinError,
    one_line,
)
from ves_twin.core.types import FloatArray
from ves_twin.core.workers import Workers
from ves_twin.envs import ENVIRONMENTS
from ves_twin.envs.baselines import BASELINES
from ves_twin.envs.policy import Policy
from ves_twin.envs.task_env import task_env
from ves_twin.envs.wrappers import RandomRigs

RESAMPLES = 2000
"""Of the bootstrap; its intervals then repeat to a few per cent of their width."""

LEVEL = 0.95
"""Of the interval."""

NO_RIGS = "none"
"""In place of a set: the plant as it is."""


@dataclass(frozen=True)
class Trial:
    """What is evaluated.

    Attributes:
        environment: id, with or without "VesTwin/".
        policy: name of a baseline, or "FILE.py:Class".
        rigs: name or file of a set, or "none".
        plant: the plant that the set changes; None for the environment's own.
    """

    environment: str
    policy: str
    rigs: str
    plant: str | None


@dataclass(frozen=True)
class Episode:
    """One episode: how it ended, summed cost [cost s], figures by name."""

    seed: int
    outcome: str
    seconds: float
    cost: float
    metrics: dict[str, float]


@dataclass(frozen=True)
class Figure:
    """Interquartile mean over episodes with the ends of its bootstrap interval."""

    iqm: float
    low: float
    high: float


@dataclass(frozen=True)
class Evaluation:
    """Episodes in the order of their seeds, and figures by name; "return" is the score."""

    trial: Trial
    episodes: tuple[Episode, ...]
    figures: dict[str, Figure]
    outcomes: dict[str, int]

    def to_dict(self) -> dict[str, object]:
        """Plain values for JSON."""
        return asdict(self)


def evaluate(
    trial: Trial,
    seeds: Sequence[int],
    workers: int = 1,
    progress: Callable[[float], None] = lambda share: None,
) -> Evaluation:
    """Run an episode for each seed; a seed fixes rig, goal and noise, whatever the policy.

    Args:
        trial: environment, policy, rigs.
        seeds: at least one.
        workers: processes.
        progress: called with the share done.

    Raises:
        UnknownNameError: no such environment, policy or set.
        VesTwinError: a policy that does not fit, or a rig that cannot be built.
    """
    if not seeds:
        raise InvalidInputError("seeds", 0, "one or more")
    environment_id(trial.environment)
    policy_class(trial.policy)
    jobs = [(trial, seed) for seed in seeds]
    episodes = []
    with Workers(workers) as pool:
        for episode in pool.map(_episode, jobs):
            episodes.append(episode)
            progress(len(episodes) / len(jobs))
    names = list(episodes[0].metrics)
    columns = {name: np.array([e.metrics[name] for e in episodes]) for name in names}
    columns["cost"] = np.array([e.cost for e in episodes])
    figures = {name: interquartile_mean(values) for name, values in columns.items()}
    outcomes = dict(sorted(Counter(e.outcome for e in episodes).items()))
    return Evaluation(trial, tuple(episodes), figures, outcomes)


def paired(one: Sequence[Episode], other: Sequence[Episode]) -> dict[str, Figure]:
    """Interquartile means of the differences of two policies' figures, seed by seed.

    A seed gives both the same rig, goal and noise, so that what these do to a score drops out.

    Args:
        one: episodes of a policy.
        other: episodes of what it is held against, with the same seeds.

    Raises:
        InvalidInputError: other seeds.
    """
    if [e.seed for e in one] != [e.seed for e in other]:
        raise InvalidInputError("paired episodes", "other seeds", "the same seeds")
    return {
        name: interquartile_mean(
            np.array([a.metrics[name] - b.metrics[name] for a, b in zip(one, other, strict=True)])
        )
        for name in one[0].metrics
    }


def environment_id(name: str) -> str:
    """The whole id of an environment given with or without its namespace.

    Raises:
        UnknownNameError: none of this room.
    """
    known = {key.split("/")[1]: key for key in ENVIRONMENTS}
    short = name.removeprefix("VesTwin/")
    if short not in known:
        raise UnknownNameError("environment", name, known)
    return known[short]


def policy_class(text: str) -> type[Policy]:
    """A baseline by name, or a class of a file by "FILE.py:Class".

    Raises:
        UnknownNameError: no such baseline or class.
        VesTwinError: code that cannot be used.
    """
    if text in BASELINES:
        return BASELINES[text]
    if ":" in text:
        return load_class(text, Policy)
    raise UnknownNameError("policy", text, BASELINES)


def built(policy: type[Policy], env: gym.Env[Any, Any]) -> Policy:
    """A policy for an environment of this room.

    Raises:
        VesTwinError: one that does not fit.
    """
    briefing = task_env(env).briefing()
    try:
        return policy.build(briefing)
    except VesTwinError:
        raise
    except Exception as error:
        what = f"policy {policy.__name__} cannot be built from a {type(briefing).__name__}"
        raise ControllerError(f"{what}: {type(error).__name__}: {one_line(error)}") from error


def interquartile_mean(values: FloatArray) -> Figure:
    """Mean of the middle half, and its percentile bootstrap interval of 95 % (seeded).

    Source: Agarwal et al., Deep RL at the edge of the statistical precipice, NeurIPS 2021.
    """
    from scipy.stats import bootstrap, trim_mean  # slow to import

    middle = float(trim_mean(values, 0.25))
    if len(values) < 2 or np.ptp(values) == 0.0:
        return Figure(middle, middle, middle)
    interval = bootstrap(
        (values,),
        lambda sample, axis: trim_mean(sample, 0.25, axis=axis),
        n_resamples=RESAMPLES,
        confidence_level=LEVEL,
        method="percentile",
        vectorized=True,
        rng=np.random.default_rng(0),
    ).confidence_interval
    return Figure(middle, float(interval.low), float(interval.high))


def run_episode(env: gym.Env[FloatArray, FloatArray], policy: Policy, seed: int) -> Episode:
    """One episode of a policy in an environment of this room, with any wrappers.

    Raises:
        ControllerError: the policy raised, or its action is no array of numbers.
    """
    observation, info = env.reset(seed=seed)
    with named(policy, 0.0):
        policy.begin(observation)
    cost, over, before = 0.0, False, 0.0
    while not over:
        with named(policy, before):
            action = np.asarray(policy.act(observation), float)
        observation, _, terminated, truncated, info = env.step(action)
        cost += info["cost"] * (info["time"] - before)
        before, over = info["time"], terminated or truncated
    return Episode(seed, info["outcome"], info["time"], cost, dict(info["metrics"]))


@contextmanager
def named(policy: Policy, time: float) -> Iterator[None]:
    """Make what a policy raises one line that names it."""
    try:
        yield
    except VesTwinError:
        raise
    except Exception as error:
        what = f"policy {type(policy).__name__} raised {type(error).__name__} at t = {time:.3f} s"
        raise ControllerError(f"{what}: {one_line(error)}") from error


def _episode(job: tuple[Trial, int]) -> Episode:
    trial, seed = job
    env = gym.make(environment_id(trial.environment), plant=trial.plant, disable_env_checker=True)
    policy = built(policy_class(trial.policy), env)
    if trial.rigs != NO_RIGS:
        env = RandomRigs(env, trial.rigs)
    try:
        return run_episode(env, policy, seed)
    finally:
        env.close()
