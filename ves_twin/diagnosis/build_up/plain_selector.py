"""PlainSelector: chooses causes by plain least squares, counting only independent rows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.build_up.memory import independent_rows
from ves_twin.diagnosis.build_up.regression import Regression
from ves_twin.diagnosis.build_up.select import CLEAR, MORE, MOST, PAIRED

ROUNDS = 3
"""Times that weights of channels are learnt anew from what they leave."""

USUAL = ("coulomb_friction", "viscous_friction")
"""Kinds that every machine has, whatever else is wrong with it."""

DRY = ("coulomb_friction",)
"""The one of them that is worth most in a short log, where two of each joint are not told apart: of
25 s of a measured arm of five axes (a youBot) 15 % of the held-out squares went, with it 55 %."""

GEARED = (*USUAL, "rotor_inertia")
"""The same of a machine with gears, whose drawing has no motors: of a measured arm of seven axes
(a Kinova Gen3, 5 s) each takes most of an axis' torque, and frictions alone took 2 % for 53 %."""


@dataclass(frozen=True)
class _Scale:
    """Weight and number of independent rows of each channel, from the residual of a choice.

    Attributes:
        weights: of the squares of each channel in its level (c,).
        count: independent rows of each (c,).
    """

    weights: FloatArray
    count: FloatArray


@dataclass(frozen=True)
class PlainSelector:
    """Forward selection by plain squares.

    A slow cause looks like coloured model error, which whitening in time removes. Plain squares
    keep it; rows count as far as they are independent. With n_c independent rows of channel c,

        2 log odds = -sum_c n_c log rms_c^2 - a'a - k (ln n + 2 ln m),

    a the amplitudes of nuisances and causes in their prior sd, k columns of m causes, n the sum of
    n_c. One by one or two together enter, the best variant of each stays, and those go without
    which the odds are better.

    Attributes:
        regression: on the fitted half.
    """

    regression: Regression

    def run(self, begin: Sequence[int] = ()) -> list[int]:
        """Chosen trials, each cause once at most.

        Args:
            begin: trials to begin with.
        """
        return self.path(begin)[-1]

    def path(self, begin: Sequence[int] = ()) -> list[list[int]]:
        """The choices on the way, the last one last."""
        chosen = self._pruned(self._swapped(list(begin), self._scale(begin)))
        found = [chosen]
        for n in range(MOST):
            if n and self.regression.half.runs.budget.skips(MORE):
                break
            scale = self._scale(chosen)
            more = self._more(chosen, scale)
            if not more or len(chosen) >= MOST:
                break
            other = self._pruned(self._swapped([*chosen, *more], scale))
            seen = self._scale(other)
            if self._odds(other, seen) <= self._odds(chosen, seen) + CLEAR:
                break
            chosen = other
            found.append(chosen)
        return found

    def usual(self, kinds: Sequence[str], beside: Sequence[int] = ()) -> list[int]:
        """Every cause of usual kinds beside some trials, in its best variant, none left out.

        Few rows of a joint that seldom turns are independent, and beside hundreds of causes none of
        them pays for itself on the fitted half. Held-out rows then say which of these are there: of
        a measured arm with 320 trials a viscous friction that takes four fifths of a joint's error.
        """
        trials = self.regression.trials
        there = {trials[n].cause.label for n in beside}
        more: dict[str, int] = {}
        for n in self.regression.rest(list(beside)):
            cause = trials[n].cause
            if cause.effect in kinds and cause.label not in there:
                more.setdefault(cause.label, n)
        chosen = [*beside, *more.values()]
        return self._swapped(chosen, self._scale(chosen)) if more else []

    def _scale(self, chosen: Sequence[int]) -> _Scale:
        """Weights and independent rows by what a choice leaves."""
        half, regression = self.regression.half, self.regression
        rows, found = np.maximum(half.kept.sum(axis=0), 1), regression.plain(chosen)
        for _ in range(ROUNDS):
            left = regression.residual(chosen, found.shares * found.scale)
            count = independent_rows(half.runs, left)
            weights = count / rows * np.square(regression.level / found.rms)
            found = regression.plain(chosen, weights, 1.0)
        return _Scale(weights, count)

    def _told(self, chosen: Sequence[int], scale: _Scale) -> tuple[float, list[int]]:
        """Logarithm of the odds of a choice, and those of it whose size cannot be."""
        regression = self.regression
        fit = regression.plain(chosen, scale.weights, 1.0)
        places = regression.places(chosen)
        odd = [n for n, at in places.items() if regression.impossible(n, fit.shares[at])]
        told = -2.0 * float(scale.count @ np.log(fit.rms)) - float(fit.shares @ fit.shares)
        price = regression.price(float(np.sum(scale.count)), regression.width(chosen))
        return 0.5 * (told - price), odd

    def _odds(self, chosen: Sequence[int], scale: _Scale) -> float:
        """The same; minus infinity where a size cannot be."""
        odds, odd = self._told(chosen, scale)
        return -np.inf if odd else odds

    def _more(self, chosen: list[int], scale: _Scale) -> list[int]:
        """The trial to add, or two that take more than twice what one does; none if none is worth.

        Two that hide each other, as a dead band and what acts beyond it, enter together.
        """
        trials, now = self.regression.trials, self._odds(chosen, scale)
        told = {n: self._told([*chosen, n], scale) for n in self.regression.rest(chosen)}
        likely = sorted(told, key=lambda n: told[n][0], reverse=True)[:PAIRED]
        worth = {n: odds - now for n, (odds, odd) in told.items() if not odd}
        both = {
            (a, b): self._odds([*chosen, a, b], scale) - now
            for a, b in combinations(likely, 2)
            if trials[a].cause.label != trials[b].cause.label
        }
        one = max(worth, key=lambda n: worth[n], default=None)
        two = max(both, key=lambda pair: both[pair], default=None)
        alone = 0.0 if one is None else worth[one]
        if two is not None and both[two] > 2.0 * max(alone, CLEAR):
            return list(two)
        return [one] if one is not None and alone > CLEAR else []

    def _swapped(self, chosen: list[int], scale: _Scale) -> list[int]:
        """With the best variant of each cause."""
        for place, n in enumerate(chosen):
            variants = [n, *(k for k in self.regression.variants(n) if k != n)]
            if len(variants) > 1:
                rest = [*chosen[:place], *chosen[place + 1 :]]
                odds = {k: self._odds([*rest, k], scale) for k in variants}
                best = max(variants, key=lambda k: odds[k])
                chosen = [*chosen[:place], best, *chosen[place + 1 :]]
        return chosen

    def _pruned(self, chosen: list[int]) -> list[int]:
        """Without those that cannot be, and those without which the odds are better."""
        while chosen:
            scale = self._scale(chosen)
            odds, odd = self._told(chosen, scale)
            if odd:
                chosen = [n for n in chosen if n != odd[-1]]
                continue
            fewer = [[k for k in chosen if k != n] for n in chosen]
            best = max(fewer, key=lambda some: self._odds(some, scale))
            if self._odds(best, scale) < odds:
                break
            chosen = best
        return chosen
