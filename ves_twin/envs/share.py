"""serve_share: the environments of one process, stepped in turn as its pipe asks."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.vector import AutoresetMode, SyncVectorEnv

import ves_twin.envs  # noqa: F401  (a process that begins here knows the ids)
from ves_twin.core.errors import VesTwinError, one_line
from ves_twin.core.types import FloatArray


@dataclass(frozen=True)
class Batch:
    """What some environments said, a row each; rewards and ends are empty after a reset."""

    observations: FloatArray
    rewards: FloatArray
    terminations: Any
    truncations: Any
    infos: dict[str, Any]


def serve_share(
    make: Callable[[], gym.Env[Any, Any]], count: int, mode: AutoresetMode, pipe: Connection
) -> None:
    """Answer a pipe until it is closed.

    Args:
        make: makes one environment.
        count: how many.
        mode: when one that is over begins anew.
        pipe: (verb, its words) come in, an answer or a VesTwinError goes out.
    """
    share: SyncVectorEnv[Any, Any] | None = None
    try:
        while True:
            what, words = pipe.recv()
            answer: Any
            try:
                share = share or SyncVectorEnv([make] * count, copy=False, autoreset_mode=mode)
                answer = _answer(share, what, words)
            except VesTwinError as error:
                answer = error
            except Exception as error:
                answer = VesTwinError(f"environment: {type(error).__name__}: {one_line(error)}")
            pipe.send(answer)
    except (EOFError, KeyboardInterrupt, ConnectionError):
        pass  # whoever asked has gone
    finally:
        if share is not None:
            share.close()


def _answer(share: SyncVectorEnv[Any, Any], what: str, words: Any) -> Any:
    if what == "step":
        return Batch(*share.step(words))
    if what == "reset":
        seeds, options = words
        observations, infos = share.reset(seed=seeds, options=options)
        none = np.empty(0)
        return Batch(observations, none, none, none, infos)
    if what == "call":
        name, args, kwargs = words
        return share.call(name, *args, **kwargs)
    if what == "set_attr":
        share.set_attr(*words)
    return None


def joined(infos: Sequence[dict[str, Any]], counts: Sequence[int]) -> dict[str, Any]:
    """Infos of shares as one, in Gymnasium's form: a row each, and `_key` says who has it.

    Args:
        infos: of each share.
        counts: environments of each share.
    """
    keys = dict.fromkeys(key for info in infos for key in info)
    return {key: _column([info.get(key) for info in infos], counts) for key in keys}


def _column(parts: Sequence[Any], counts: Sequence[int]) -> Any:
    first = next(part for part in parts if part is not None)
    if isinstance(first, dict):
        return joined([part or {} for part in parts], counts)
    rows = [
        np.full((count, *first.shape[1:]), None if first.dtype == object else 0, first.dtype)
        if part is None
        else part
        for part, count in zip(parts, counts, strict=True)
    ]
    return np.concatenate(rows)
