"""ChunkedVectorEnv: environments side by side, shared out over a few threads."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from functools import partial
from itertools import pairwise
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.vector import AutoresetMode, SyncVectorEnv, VectorEnv
from gymnasium.vector.utils import batch_space

from ves_twin.core.errors import InvalidInputError, UnknownNameError, VesTwinError, one_line
from ves_twin.core.types import FloatArray
from ves_twin.envs.batched_infos import batched_infos

MODES = (AutoresetMode.NEXT_STEP.value, AutoresetMode.SAME_STEP.value)
"""When an environment that is over begins anew: by the next step, or within the last one."""

Wrap = Callable[[gym.Env[Any, Any]], gym.Env[Any, Any]]


class ChunkedVectorEnv(VectorEnv[FloatArray, FloatArray, Any]):
    """Environments of one kind, each equal to a single one to the last bit.

    A thread steps its share one after another, and makes, draws and closes it, too. The compiled
    loop runs beside other threads (it holds no lock of the interpreter), and what a step gives
    travels nowhere. Gymnasium's `AsyncVectorEnv` has a process for each environment: each step of
    each costs two messages and a cold cache. Seeds, resets, infos and the batch are as there.

    Args:
        name: id of the environment.
        num_envs: how many.
        threads: how many share them; one for each core if left out.
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
        threads: int | None = None,
        wrappers: Sequence[Wrap] = (),
        autoreset_mode: str = AutoresetMode.NEXT_STEP.value,
        **options: Any,
    ) -> None:
        self._pools: list[ThreadPoolExecutor] = []
        self._parts: list[Any] = []
        for what, count in (("num_envs", num_envs), ("threads", threads)):
            if count is not None and (type(count) is not int or count < 1):
                raise InvalidInputError(what, count, "a whole number, 1 or more")
        if autoreset_mode not in MODES:
            raise UnknownNameError("autoreset_mode", str(autoreset_mode), MODES)
        mode = AutoresetMode(autoreset_mode)
        make = partial(_made, name, tuple(wrappers), options)
        self._describe(make(), num_envs, mode)
        count = min(threads or os.cpu_count() or 1, num_envs)
        ends = [num_envs * k // count for k in range(count + 1)]
        self._shares = [slice(a, b) for a, b in pairwise(ends)]
        self._pools = [ThreadPoolExecutor(1) for _ in self._shares]
        share = partial(_Share, copy=False, autoreset_mode=mode)
        made = [[make] * (one.stop - one.start) for one in self._shares]
        try:
            self._parts = self._each([partial(share, one) for one in made])
        except VesTwinError:
            self.close()
            raise

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
        given = [{"seed": list(seeds[share]), "options": options} for share in self._shares]
        observations, infos = zip(*self._ask("reset", named=given), strict=True)
        return np.concatenate(observations), _batched(infos)

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
        said = self._ask("step", [(given[share],) for share in self._shares])
        *rows, infos = zip(*said, strict=True)
        observations, rewards, terminations, truncations = map(np.concatenate, rows)
        return observations, rewards, terminations, truncations, _batched(infos)

    def call(self, name: str, *args: Any, **kwargs: Any) -> tuple[Any, ...]:
        """What a method of each gives, or an attribute."""
        count = len(self._shares)
        said = self._ask("call", [(name, *args)] * count, [kwargs] * count)
        return tuple(value for values in said for value in values)

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
        """Close the environments, each in its thread, and end the threads."""
        for pool, part in zip(self._pools, self._parts, strict=False):
            pool.submit(part.close)
        for pool in self._pools:
            pool.shutdown()

    def _ask(
        self, verb: str, said: Sequence[Any] = (), named: Sequence[dict[str, Any]] = ()
    ) -> list[Any]:
        """What a verb of each share gives."""
        if self.closed:
            raise InvalidInputError("environments", "closed", "open ones")
        count = len(self._parts)
        words = zip(self._parts, said or [()] * count, named or [{}] * count, strict=True)
        return self._each([partial(getattr(part, verb), *one, **keys) for part, one, keys in words])

    def _each(self, works: Sequence[Callable[[], Any]]) -> list[Any]:
        """Works of all shares at the same time; all are at their end before any error is told."""
        answers = [pool.submit(work) for pool, work in zip(self._pools, works, strict=True)]
        wait(answers)
        for answer in answers:
            error = answer.exception()
            if isinstance(error, VesTwinError):
                raise error
            if error is not None:
                what = f"environment: {type(error).__name__}: {one_line(error)}"
                raise VesTwinError(what) from error
        return [answer.result() for answer in answers]


class _Share(SyncVectorEnv[Any, Any]):
    """The environments of one thread; infos are put together once, of all shares."""

    def _add_info(self, vector_infos: Any, env_info: dict[str, Any], env_num: int) -> Any:
        vector_infos.setdefault(env_num, {}).update(env_info)
        return vector_infos


def _batched(infos: Sequence[dict[int, dict[str, Any]]]) -> dict[str, Any]:
    """Of shares, whose infos are by the number of the environment in each."""
    return batched_infos([one[n] for one in infos for n in range(len(one))])


def _made(name: str, wrappers: Sequence[Wrap], options: dict[str, Any]) -> gym.Env[Any, Any]:
    env: gym.Env[Any, Any] = gym.make(name, **options)
    for wrap in wrappers:
        env = wrap(env)
    return env
