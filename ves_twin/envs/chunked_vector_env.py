"""ChunkedVectorEnv: environments side by side, shared out over a few processes."""

from __future__ import annotations

import multiprocessing
import os
from collections.abc import Callable, Sequence
from functools import partial
from itertools import pairwise
from multiprocessing.connection import Connection
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import CloudpickleWrapper, batch_space

from ves_twin.core.errors import InvalidInputError, UnknownNameError, VesTwinError
from ves_twin.core.types import FloatArray
from ves_twin.core.workers import single_threads
from ves_twin.envs.share import Batch, joined, serve_share

MODES = (AutoresetMode.NEXT_STEP.value, AutoresetMode.SAME_STEP.value)
"""When an environment that is over begins anew: by the next step, or within the last one."""

Wrap = Callable[[gym.Env[Any, Any]], gym.Env[Any, Any]]


class ChunkedVectorEnv(VectorEnv[FloatArray, FloatArray, Any]):
    """Environments of one kind, each equal to a single one to the last bit.

    A process steps its share one after another. Gymnasium's `AsyncVectorEnv` has a process for
    each environment: with more of them than cores they take turns, and each step of each
    environment costs two messages and a cold cache. Seeds, resets, infos and the batch are as
    there. Values that `call` and `get_attr` give travel, so they must be picklable.

    Attributes:
        processes: those that share the environments.

    Args:
        name: id of the environment.
        num_envs: how many.
        processes: how many share them; one for each core if left out.
        wrappers: put around each environment, the innermost first.
        autoreset_mode: one of MODES.
        **options: for the environment, as `gym.make` takes them.

    Raises:
        VesTwinError: what cannot be made.
    """

    def __init__(
        self,
        name: str,
        num_envs: int,
        processes: int | None = None,
        wrappers: Sequence[Wrap] = (),
        autoreset_mode: str = AutoresetMode.NEXT_STEP.value,
        **options: Any,
    ) -> None:
        self._pipes: list[Connection] = []
        self.processes: list[Any] = []
        for what, count in (("num_envs", num_envs), ("processes", processes)):
            if count is not None and (type(count) is not int or count < 1):
                raise InvalidInputError(what, count, "a whole number, 1 or more")
        if autoreset_mode not in MODES:
            raise UnknownNameError("autoreset_mode", str(autoreset_mode), MODES)
        mode = AutoresetMode(autoreset_mode)
        make = partial(_made, name, tuple(wrappers), options)
        self._describe(make(), num_envs, mode)
        count = min(processes or os.cpu_count() or 1, num_envs)
        ends = [num_envs * k // count for k in range(count + 1)]
        self._shares = [slice(a, b) for a, b in pairwise(ends)]
        context = multiprocessing.get_context("spawn")  # libraries' threads do not survive a fork
        with single_threads():
            for share in self._shares:
                ours, theirs = context.Pipe()
                given = (CloudpickleWrapper(make), share.stop - share.start, mode, theirs)
                process = context.Process(target=serve_share, args=given, daemon=True)
                process.start()
                theirs.close()
                self._pipes.append(ours)
                self.processes.append(process)
        self._ask("begin", [None] * count)

    def _describe(self, one: gym.Env[Any, Any], num_envs: int, mode: AutoresetMode) -> None:
        self.num_envs = num_envs
        self.metadata = {**one.metadata, "autoreset_mode": mode}
        self.render_mode = one.render_mode
        self.single_observation_space = one.observation_space
        self.single_action_space = one.action_space
        self.observation_space = batch_space(one.observation_space, num_envs)
        self.action_space = batch_space(one.action_space, num_envs)
        one.close()

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[FloatArray, dict[str, Any]]:
        """Begin an episode in each.

        Args:
            seed: one for each; a number is that of the first, the next one has one more, and so on.
            options: of each environment's `reset`.

        Raises:
            VesTwinError: another number of seeds, or what an environment refuses.
        """
        seeds = [seed + i for i in range(self.num_envs)] if isinstance(seed, int) else seed
        if seeds is None:
            seeds = [None] * self.num_envs
        if "reset_mask" in (options or {}):
            raise InvalidInputError(
                "options", "reset_mask", "plant, scenario or goal: all begin anew"
            )
        if len(seeds) != self.num_envs:
            raise InvalidInputError("seed", seed, f"a number, or {self.num_envs} of them")
        said = [(list(seeds[share]), options) for share in self._shares]
        batches = self._ask("reset", said)
        return np.concatenate([b.observations for b in batches]), self._infos(batches)

    def step(self, actions: FloatArray) -> tuple[FloatArray, FloatArray, Any, Any, dict[str, Any]]:
        """A step of each.

        Args:
            actions: a row for each.

        Raises:
            InvalidInputError: another shape, or not finite; nothing has moved then.
        """
        given = np.asarray(actions, float)
        if given.shape != self.action_space.shape or not np.all(np.isfinite(given)):
            what = f"finite numbers of shape {self.action_space.shape}"
            raise InvalidInputError("actions", given.tolist(), what)
        batches: list[Batch] = self._ask("step", [given[share] for share in self._shares])
        return (
            np.concatenate([b.observations for b in batches]),
            np.concatenate([b.rewards for b in batches]),
            np.concatenate([b.terminations for b in batches]),
            np.concatenate([b.truncations for b in batches]),
            self._infos(batches),
        )

    def call(self, name: str, *args: Any, **kwargs: Any) -> tuple[Any, ...]:
        """What a method of each gives, or an attribute."""
        said = [(name, args, kwargs)] * len(self._shares)
        return tuple(value for values in self._ask("call", said) for value in values)

    def get_attr(self, name: str) -> tuple[Any, ...]:
        """An attribute of each."""
        return self.call(name)

    def set_attr(self, name: str, values: Any) -> None:
        """Set an attribute: a list or tuple has one value for each, else all have the same."""
        given = values if isinstance(values, list | tuple) else [values] * self.num_envs
        if len(given) != self.num_envs:
            raise InvalidInputError(name, values, f"one value, or {self.num_envs} of them")
        self._ask("set_attr", [(name, list(given[share])) for share in self._shares])

    def render(self) -> tuple[Any, ...]:
        """A picture of each."""
        return self.call("render")

    def close_extras(self, **kwargs: Any) -> None:
        """End the processes."""
        for pipe in self._pipes:
            pipe.close()  # a process ends when its pipe does
        for process in self.processes:
            process.join()

    def _infos(self, batches: Sequence[Batch]) -> dict[str, Any]:
        return joined([batch.infos for batch in batches], [len(b.observations) for b in batches])

    def _ask(self, what: str, said: Sequence[Any]) -> list[Any]:
        """Answers of the processes, which work at the same time; all are heard before any error."""
        if self.closed:
            raise InvalidInputError("environments", "closed", "open ones")
        answers: list[Any] = []
        try:
            for pipe, words in zip(self._pipes, said, strict=True):
                pipe.send((what, words))
            answers = [pipe.recv() for pipe in self._pipes]
        except (EOFError, ConnectionError) as error:
            self.close()
            raise VesTwinError("a process of the environments has ended; make them anew") from error
        for answer in answers:
            if isinstance(answer, VesTwinError):
                raise answer
        return answers


def _made(name: str, wrappers: Sequence[Wrap], options: dict[str, Any]) -> gym.Env[Any, Any]:
    env: gym.Env[Any, Any] = gym.make(name, **options)
    for wrap in wrappers:
        env = wrap(env)
    return env
