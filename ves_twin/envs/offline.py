"""record_dataset: episodes of a policy as a Minari data set, for learning off line."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import gymnasium as gym
import numpy as np

from ves_twin import __version__
from ves_twin.core.errors import InvalidInputError, UnknownNameError, VesTwinError
from ves_twin.core.json_text import json_text
from ves_twin.core.types import FloatArray
from ves_twin.envs.baselines import EXPERTS
from ves_twin.envs.evaluation import NO_RIGS, built, environment_id, named, policy_class
from ves_twin.envs.policy import Policy
from ves_twin.envs.task_env import task_env
from ves_twin.envs.wrappers import RandomRigs

try:
    import minari
    from minari.data_collector import EpisodeBuffer
except ImportError:
    raise VesTwinError(
        "data sets need the package minari: pip install 'ves_twin[minari]'"
    ) from None

if TYPE_CHECKING:
    from minari import MinariDataset

KINDS = ("expert", "behaviour", "random")
"""expert: the policy itself; behaviour: with noise on each action; random: even over the range."""

SPREAD = 0.3
"""Standard deviation of the noise of `behaviour`, of an action's range from 0 to 1; assumed."""

STREAM = 4
"""Number of the stream that the noise of actions is drawn from, beside those of the wrappers."""


@dataclass(frozen=True)
class Record:
    """What is recorded.

    Attributes:
        environment: id, with or without "VesTwin/".
        kind: one of KINDS.
        policy: a baseline or "FILE.py:Class"; None for the environment's expert of EXPERTS.
        rigs: name or file of a set whose faults are hidden in the episodes, or "none".
        plant: the plant that the set changes; None for the environment's own.
        scaled: float32 shares in place of physical units.
        name: id of the data set; made of the rest if left out.
    """

    environment: str
    kind: str = "expert"
    policy: str | None = None
    rigs: str = "train-v0"
    plant: str | None = None
    scaled: bool = False
    name: str | None = None

    @property
    def dataset_id(self) -> str:
        """For instance "VesTwin/VibrationDamping/expert-train-v0"."""
        if self.name is not None:
            return self.name
        short = environment_id(self.environment).rpartition("-")[0]
        rigs = "v0" if self.rigs == NO_RIGS else self.rigs
        return f"{short}/{self.kind}-{rigs}"


def record_dataset(
    record: Record,
    seeds: Sequence[int],
    progress: Callable[[float], None] = lambda share: None,
) -> MinariDataset:
    """Run an episode for each seed and keep them in Minari's folder (MINARI_DATASETS_PATH).

    Seeds fix rig, goal and noise as in `evaluate`. What was wrong with the rig of an episode is
    in the episode's metadata ("effects", JSON), never in observations or infos.

    Args:
        record: what is recorded.
        seeds: at least one.
        progress: called with the share done.

    Raises:
        UnknownNameError: no such environment, policy, set or kind.
        InvalidInputError: an id that is none, or that is taken.
        VesTwinError: a policy that does not fit, or a rig that cannot be built.
    """
    if not seeds:
        raise InvalidInputError("seeds", 0, "one or more")
    if record.kind not in KINDS:
        raise UnknownNameError("kind", record.kind, KINDS)
    _check_free(record.dataset_id)
    identity = environment_id(record.environment)
    chosen = record.policy or ("still" if record.kind == "random" else EXPERTS[identity])
    made_by = record.kind if record.kind == "random" else f"{record.kind} of {chosen}"
    made = policy_class(chosen)  # an unknown one is refused before anything is made
    env: gym.Env[Any, Any] = gym.make(
        identity, plant=record.plant, scaled=record.scaled, disable_env_checker=True
    )
    if record.rigs != NO_RIGS:
        env = RandomRigs(env, record.rigs)
    policy = built(made, env)
    buffers, told = [], []
    try:
        for count, seed in enumerate(seeds, 1):
            buffers.append(_play(env, policy, record.kind, seed))
            told.append({"rewards_sum": sum(buffers[-1].rewards), "effects": _effects(env)})
            progress(count / len(seeds))
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", "`(author_email|eval_env|code_permalink)` is set")
            data = minari.create_dataset_from_buffers(
                record.dataset_id,
                buffers,
                env,
                algorithm_name=made_by,
                author=f"ves_twin {__version__}",
                description=f"{identity}, rigs of {record.rigs}, seeds {seeds[0]} to {seeds[-1]}",
                requirements=[f"ves_twin=={__version__}"],
            )
    finally:
        env.close()
    data.storage.update_episode_metadata(told)
    return data


def _play(env: gym.Env[Any, Any], policy: Policy, kind: str, seed: int) -> EpisodeBuffer:
    """One episode; policies see readings in their units, whatever the environment shows."""
    inner, rng = task_env(env), np.random.default_rng([seed, STREAM])
    rows, actions, gains = [env.reset(seed=seed)[0]], [], []
    with named(policy, 0.0):
        policy.begin(inner.reading)
    ends, time = [(False, False)], 0.0
    while not any(ends[-1]):
        with named(policy, time):
            action = np.asarray(policy.act(inner.reading), float)
        actions.append(_kind_of(kind, action, rng).astype(inner.action_space.dtype))
        seen, gain, terminated, truncated, info = env.step(actions[-1])
        rows.append(seen)
        gains.append(float(gain))
        ends.append((terminated, truncated))
        time = info["time"]
    terminations, truncations = (list(column) for column in zip(*ends[1:], strict=True))
    return EpisodeBuffer(
        seed=seed,
        observations=rows,
        actions=actions,
        rewards=gains,
        terminations=terminations,
        truncations=truncations,
    )


def _kind_of(kind: str, action: FloatArray, rng: np.random.Generator) -> FloatArray:
    if kind == "random":
        return rng.uniform(-1.0, 1.0, action.shape)
    spread = SPREAD if kind == "behaviour" else 0.0
    return np.clip(action + spread * rng.standard_normal(action.shape), -1.0, 1.0)


def _effects(env: gym.Env[Any, Any]) -> str:
    """What was wrong with the rig of the episode, as JSON."""
    return json_text(task_env(env).faults)


def _check_free(name: str) -> None:
    """Refuse before the first episode what could not be kept after the last one."""
    from minari.dataset.minari_dataset import parse_dataset_id
    from minari.storage.datasets_root_dir import get_dataset_path

    try:
        parse_dataset_id(name)
    except ValueError:
        raise InvalidInputError("name", name, "FOLDER/NAME-v0, an id of Minari") from None
    if get_dataset_path(name).exists():
        raise InvalidInputError("name", name, "the id of a data set that is not there yet")
