"""ModelError: what a model gets wrong in one column, whatever causes its library has."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from scipy.signal import lfilter

from ves_twin.core.types import FloatArray

MEMORY = (0.05, 0.5)
"""Times over which coloured error remembers itself, log-uniform [s]: that of slow error on the
measured machines of docs/real-machines.md."""

OUTSIDE = (0.05, 0.10)
"""Rms of a cause outside the library, of that of its column."""

MOST_OUTSIDE = 2
"""Causes outside the library of one machine at most."""

FEATURES = 4
"""Sines that a law of the motion is made of."""

STEEP = 1.25
"""Sd of what turns a sine's phase, for one typical size of each variable [rad]."""


class Family(StrEnum):
    """Sorts of causes outside the library.

    COLOURED: coloured noise, new in each recording. LAW: a function of the motion, the same in all.
    """

    COLOURED = "coloured"
    LAW = "law"


@dataclass(frozen=True)
class ModelError:
    """Error of one column.

    Attributes:
        family: what it is.
        column: number of the channel.
        size: rms [unit of the channel].
        memory: of coloured error [s].
        seed: of a law.
    """

    family: Family
    column: int
    size: float
    memory: float = 0.0
    seed: int = 0

    @staticmethod
    def of(content: Mapping[str, float | str]) -> ModelError:
        """From a file."""
        given = {name: float(content[name]) for name in ("size", "memory")}
        seed, column = int(content["seed"]), int(content["column"])
        return ModelError(
            Family(str(content["family"])), column, given["size"], given["memory"], seed
        )

    def rows(self, motion: FloatArray, period: float, rng: np.random.Generator) -> FloatArray:
        """What is added to the column (n,).

        Args:
            motion: variables of a law in typical sizes (n, k).
            period: from row to row [s].
            rng: of coloured error.
        """
        if self.family is Family.LAW:
            return self.size * _law(np.random.default_rng(self.seed), motion)
        keeps = float(np.exp(-period / self.memory))
        lead = round(5.0 * self.memory / period)
        white = rng.standard_normal(len(motion) + lead)
        shaped = lfilter([np.sqrt(1.0 - keeps**2)], [1.0, -keeps], white)
        return np.asarray(self.size * shaped[lead:])


def _law(rng: np.random.Generator, motion: FloatArray) -> FloatArray:
    """A smooth function that nobody has: sines of random directions, of rms near 1 (n,)."""
    turns = STEEP * rng.standard_normal((motion.shape[1], FEATURES))
    phases = rng.uniform(0.0, 2.0 * np.pi, FEATURES)
    return np.asarray(np.sin(motion @ turns + phases).sum(axis=1) / np.sqrt(0.5 * FEATURES))


def everywhere(
    share: float, levels: FloatArray, rng: np.random.Generator
) -> tuple[ModelError, ...]:
    """Coloured error of every column.

    Args:
        share: its rms, of that of the column.
        levels: rms of each column (c,).
        rng: of how long each remembers itself.
    """
    low, high = np.log(MEMORY)
    memories = np.exp(rng.uniform(low, high, len(levels)))
    pairs = enumerate(zip(levels, memories, strict=True))
    return tuple(ModelError(Family.COLOURED, c, share * float(a), float(m)) for c, (a, m) in pairs)


def outside_library(levels: FloatArray, rng: np.random.Generator) -> tuple[ModelError, ...]:
    """One cause or two that no library has, all of a family, each in a column of its own."""
    family = Family(rng.choice([one.value for one in Family]))
    count = int(rng.integers(1, MOST_OUTSIDE + 1))
    columns = rng.choice(len(levels), min(count, len(levels)), replace=False)
    low, high = np.log(MEMORY)
    return tuple(
        ModelError(
            family,
            int(c),
            float(rng.uniform(*OUTSIDE) * levels[c]),
            float(np.exp(rng.uniform(low, high))),
            int(rng.integers(2**31)),
        )
        for c in columns
    )
