"""PlainSelector: causes that take most of the plain error, rows that remember each other aside."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.build_up.memory import independent_rows
from ves_twin.diagnosis.build_up.regression import Regression
from ves_twin.diagnosis.build_up.select import CLEAR, MOST, PAIRED

ROUNDS = 3
"""Times that weights of channels are learnt anew from what they leave."""


@dataclass(frozen=True)
class _Scale:
    """What plain squares are weighed by, as one choice leaves them.

    Attributes:
        weights: of the squares of each channel in its level (c,).
        count: rows of each that count by themselves (c,).
    """

    weights: FloatArray
    count: FloatArray


@dataclass(frozen=True)
class PlainSelector:
    """Forward selection by plain squares: where what is missing is slow, it passes for discrepancy.

    Whitening in time hides then what acts slowly. Here a channel of n_c independent rows is worth

        2 log odds = -sum_c n_c log rms_c^2 - sum (nu / sd)^2 - k (ln n + 2 ln m),

    k columns of m causes, n the sum of n_c. One by one or two together enter, the best variant of
    each stays, and those go without which the odds are better.

    Attributes:
        regression: on the fitted half.
    """

    regression: Regression

    def run(self, begin: Sequence[int] = ()) -> list[int]:
        """Chosen trials, each cause once at most.

        Args:
            begin: trials to begin with.
        """
        chosen = list(begin)
        for _ in range(MOST):
            scale = self._scale(chosen)
            more = self._more(chosen, scale)
            if not more:
                break
            other = self._pruned(self._swapped([*chosen, *more], scale))
            seen = self._scale(other)
            if self._odds(other, seen) <= self._odds(chosen, seen) + CLEAR:
                break
            chosen = other
        return chosen

    def _scale(self, chosen: Sequence[int]) -> _Scale:
        """Weights and independent rows by what a choice leaves."""
        half, regression = self.regression.half, self.regression
        rows, found = np.maximum(half.kept.sum(axis=0), 1), regression.plain(chosen)
        columns, _ = regression.design(chosen)
        for _ in range(ROUNDS):
            left = half.target - np.tensordot(found.shares * found.scale, columns, axes=1)
            count = independent_rows(half.runs, left)
            weights = count / rows * np.square(regression.level / found.rms)
            found = regression.plain(chosen, weights, 1.0)
        return _Scale(weights, count)

    def _odds(self, chosen: Sequence[int], scale: _Scale) -> float:
        """Logarithm of the odds of a choice; minus infinity where a size cannot be."""
        regression = self.regression
        fit = regression.plain(chosen, scale.weights, 1.0)
        for n, at in regression.places(chosen).items():
            if regression.impossible(n, fit.shares[at]):
                return -np.inf
        told = -2.0 * float(scale.count @ np.log(fit.rms)) - float(fit.shares @ fit.shares)
        price = regression.price(float(np.sum(scale.count)), regression.width(chosen))
        return 0.5 * (told - price)

    def _more(self, chosen: list[int], scale: _Scale) -> list[int]:
        """The trial to add, or two that take more than twice what one does; none if none is worth.

        Two that hide each other, as a dead band and what acts beyond it, enter together.
        """
        trials, now = self.regression.trials, self._odds(chosen, scale)
        worth = {n: self._odds([*chosen, n], scale) - now for n in self.regression.rest(chosen)}
        likely = sorted(worth, key=lambda n: worth[n], reverse=True)[:PAIRED]
        if not likely:
            return []
        both = {
            (a, b): self._odds([*chosen, a, b], scale) - now
            for a, b in combinations(likely, 2)
            if trials[a].cause.label != trials[b].cause.label
        }
        one, two = likely[0], max(both, key=lambda pair: both[pair], default=None)
        if two is not None and both[two] > 2.0 * max(worth[one], CLEAR):
            return list(two)
        return [one] if worth[one] > CLEAR else []

    def _swapped(self, chosen: list[int], scale: _Scale) -> list[int]:
        """With the best variant of each cause."""
        for place, n in enumerate(chosen):
            others = [*chosen[:place], *chosen[place + 1 :]]
            variants = self.regression.variants(n)
            best = max(variants, key=lambda k: self._odds([*others, k], scale))
            chosen = [*chosen[:place], best, *chosen[place + 1 :]]
        return chosen

    def _pruned(self, chosen: list[int]) -> list[int]:
        """Without those without which the odds are better."""
        while chosen:
            scale = self._scale(chosen)
            fewer = [[k for k in chosen if k != n] for n in chosen]
            best = max(fewer, key=lambda some: self._odds(some, scale))
            if self._odds(best, scale) < self._odds(chosen, scale):
                break
            chosen = best
        return chosen
