"""Joint: scores of every cause on every day, with what the days share marginalised."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.trend.day import Telling

LEAST = 1e-12
"""Power [sigma^2] of a direction below which it counts as not there, of the largest."""


@dataclass(frozen=True)
class Joint:
    """u = S'M z and G = S'M S for all causes and days, M with shared parameters marginalised.

    Of days k with information (P'P, P'S, S'S)_k: L = I + sum P_k'P_k, and
    G_kl = S_k'S_k d_kl - S_k'P_k L^-1 P_l'S_l. If nothing is wrong u is normal with covariance G.

    Attributes:
        score: u (causes, n).
        gram: G (causes, n, causes, n).
    """

    score: FloatArray
    gram: FloatArray

    @staticmethod
    def of(days: Sequence[Telling]) -> Joint:
        """Of recordings of one rig."""
        p, n = days[0].shared, len(days)
        count = len(days[0].score) - p
        total = np.eye(p) + sum(day.information[:p, :p] for day in days)
        pull = np.linalg.solve(total, np.sum([day.score[:p] for day in days], axis=0))
        across = [np.linalg.solve(total, day.information[:p, p:]) for day in days]
        score, gram = np.zeros((count, n)), np.zeros((count, n, count, n))
        for k, day in enumerate(days):
            score[:, k] = day.score[p:] - day.information[p:, :p] @ pull
            for m in range(n):
                gram[:, k, :, m] = -day.information[p:, :p] @ across[m]
            gram[:, k, :, k] += day.information[p:, p:]
        return Joint(score, gram)

    def power(self, cause: int) -> FloatArray:
        """G of one cause (n, n)."""
        return np.asarray(self.gram[cause, :, cause, :])

    def free(self, cause: int) -> float:
        """chi^2 that a size of its own on each day takes away."""
        power = self.power(cause)
        return float(self.score[cause] @ np.linalg.pinv(power, LEAST, True) @ self.score[cause])

    @cached_property
    def root(self) -> FloatArray:
        """R with R R' = G, flat over causes and days."""
        size = self.score.size
        values, vectors = np.linalg.eigh(self.gram.reshape(size, size))
        return np.asarray(vectors * np.sqrt(np.maximum(values, 0.0)))

    def draws(self, rng: np.random.Generator, count: int) -> FloatArray:
        """Scores (count, causes, n) of rigs with nothing wrong."""
        flat = rng.standard_normal((count, self.score.size)) @ self.root.T
        return np.asarray(flat.reshape(count, *self.score.shape))


def directions(power: FloatArray, columns: FloatArray) -> FloatArray:
    """Columns (m, n) less their constant part and of unit power, so that (w'u)^2 is chi^2.

    Of a model u = A (a 1 + b c) the constant is free: c - 1 (1'A c) / (1'A 1) is what is left.
    A column that the record cannot see becomes zero.
    """
    one = np.ones(len(power))
    base = power @ one
    whole = float(one @ base)
    left = columns - np.outer(columns @ base, one) / whole if whole > 0.0 else 0.0 * columns
    size = np.einsum("mi,ij,mj->m", left, power, left)
    seen = size > LEAST * max(float(np.max(size, initial=0.0)), 1e-300)
    return np.asarray(np.where(seen, 1.0 / np.sqrt(np.where(seen, size, 1.0)), 0.0)[:, None] * left)
