"""Gains: what trials would take beside a fit, each alone, and every two together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import numpy as np

from ves_twin.core.types import FloatArray, IntArray


@dataclass(frozen=True)
class Gains:
    """What trials would take beside a fit.

    Attributes:
        gram: of their columns in prior sd, less what the fit can explain (m, m).
        slope: of the squares along each, halved (m,).
        where: columns of each trial.
        low, high: amplitudes that the range of each allows (m,).
    """

    gram: FloatArray
    slope: FloatArray
    where: dict[int, IntArray]
    low: FloatArray
    high: FloatArray

    def free(self, *trials: int) -> FloatArray:
        """Amplitudes [prior sd] that they would have together, whatever their ranges."""
        at = np.concatenate([self.where[n] for n in trials])
        return np.asarray(np.linalg.solve(self._inner(at), self.slope[at]), float)

    def of(self, *trials: int) -> float:
        """Squares that trials take together, as far as their ranges allow."""
        if len(trials) == 1:
            return self._alone[trials[0]]
        return self._taken(trials)

    def unbounded(self, trial: int) -> float:
        """Squares that a trial alone would take, whatever its range."""
        return float(self.slope[self.where[trial]] @ self.free(trial))

    def of_pairs(self, trials: Sequence[int]) -> dict[tuple[int, int], float]:
        """What every two take, as `of` has it: of single columns all at once."""
        at = np.array([self.where[n][0] for n in trials], int)
        taken = self._of_two(*(at[k] for k in np.triu_indices(len(trials), 1)))
        found = dict(zip(combinations(trials, 2), taken.tolist(), strict=True))
        wide = {n for n in trials if len(self.where[n]) > 1}
        return found | {pair: self._taken(pair) for pair in found if wide.intersection(pair)}

    @cached_property
    def _alone(self) -> dict[int, float]:
        """What each trial takes."""
        inner = np.diag(self.gram) + 1.0
        shares = np.clip(self.slope / inner, self.low, self.high)
        taken = np.maximum(2.0 * self.slope * shares - inner * np.square(shares), 0.0)
        return {
            n: float(taken[at[0]]) if len(at) == 1 else self._taken([n])
            for n, at in self.where.items()
        }

    def _taken(self, trials: Sequence[int]) -> float:
        at = np.concatenate([self.where[n] for n in trials])
        shares = np.clip(self.free(*trials), self.low[at], self.high[at])
        taken = 2.0 * self.slope[at] @ shares - shares @ self._inner(at) @ shares
        return max(float(taken), 0.0)

    def _inner(self, at: IntArray) -> FloatArray:
        return np.asarray(self.gram[np.ix_(at, at)] + np.eye(len(at)))

    def _of_two(self, a: IntArray, b: IntArray) -> FloatArray:
        """What columns a and b take together (k,), by Cramer's rule."""
        of_a, of_b = self.gram[a, a] + 1.0, self.gram[b, b] + 1.0
        both, at_a, at_b = self.gram[a, b], self.slope[a], self.slope[b]
        least = of_a * of_b - np.square(both)
        first = np.clip((at_a * of_b - at_b * both) / least, self.low[a], self.high[a])
        second = np.clip((at_b * of_a - at_a * both) / least, self.low[b], self.high[b])
        squares = of_a * np.square(first) + of_b * np.square(second) + 2.0 * both * first * second
        return np.maximum(2.0 * (at_a * first + at_b * second) - squares, 0.0)
