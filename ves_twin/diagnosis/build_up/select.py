"""Selector: which trials are worth a proof, on the fitted half: one by one, in pairs, exchanged."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ves_twin.diagnosis.build_up.discrepancy import discrepancy
from ves_twin.diagnosis.build_up.gains import Gains
from ves_twin.diagnosis.build_up.regression import LinearFit, Regression

MOST = 60
"""Trials that may be chosen: beyond that a record of any length is described, not explained."""

PAIRED = 30
"""Trials, by falling gain, of which every two are tried together."""

MORE = "more causes beside those that were chosen"
"""What is left out where the time ends before the search for them does."""

CLEAR = 1.0
"""Logarithm of odds by which a choice must be better than the last one for the search to go on."""

TRIED = 5
"""Exchanges, by falling promise, whose discrepancy is learnt anew: one alone often only seems."""


@dataclass(frozen=True)
class _Choice:
    """Chosen trials, their fit, and what it is worth."""

    chosen: list[int]
    fit: LinearFit
    evidence: float


@dataclass(frozen=True)
class Selector:
    """Forward selection against a discrepancy that is learnt anew after each step.

    A trial of k columns enters where it takes more than k (ln n + 2 ln m) of chi^2, n samples and
    m causes: the Bayesian information criterion, extended for the many that were looked at. Then
    one after the other goes, or is exchanged for another one, while that criterion gets better:
    what entered first may only stand for what came later (gains for frictions of an arm).

    Source: Chen and Chen 2008, Extended Bayesian information criteria, Biometrika 95.

    Attributes:
        regression: on the fitted half.
    """

    regression: Regression

    def run(self, begin: Sequence[int] = ()) -> list[int]:
        """Chosen trials, each cause once at most.

        Args:
            begin: trials to begin with.
        """
        now, budget = self._grown(list(begin)), self.regression.half.runs.budget
        while not budget.skips("others in the place of chosen causes"):
            other = self._exchanged(now) or self._grown(now.chosen)
            if other.evidence <= now.evidence + CLEAR:
                break
            now = other
        return now.chosen

    def best(self) -> list[list[int]]:
        """The best single trial, and the best two together, of all.

        By a discrepancy that is learnt without any, and by plain squares: where most of what is
        there is one cause's, it passes for discrepancy whose whitening hides it (dry friction of
        both joints of a double pendulum).
        """
        rest, regression = self.regression.rest([]), self.regression
        if not rest:
            return []
        learnt = regression.fit([])
        plain = discrepancy(regression.half.runs, regression.half.target, memory=False)
        found: dict[frozenset[int], list[int]] = {}
        for fit in (learnt, regression.solve([], plain)):
            gains = regression.gains(fit, rest)
            single = max(rest, key=gains.of)
            pair = self._pair(gains, rest)
            for few in ([single], list(pair or ())):
                sound = self.swapped(few)
                found.setdefault(frozenset(sound), sound)
        return [few for few in found.values() if few]

    def _grown(self, chosen: list[int]) -> _Choice:
        """With all that is worth its price beside a choice, and without what is not any more."""
        fit = self.regression.fit(chosen)
        while len(chosen) < MOST and not (chosen and self.regression.half.runs.budget.skips(MORE)):
            more, there = self._next(chosen, fit)
            if there is None:
                break
            chosen = self.swapped([*chosen, *more])
            fit = self.regression.fit(chosen, there.whitening, 2)
        return self._pruned(chosen)

    def _exchanged(self, now: _Choice) -> _Choice | None:
        """The choice with one cause in the place of another, if that is clearly better."""
        regression, trials = self.regression, self.regression.trials
        rest, promises = regression.rest(now.chosen), list[tuple[float, int, int]]()

        def worth(gains: Gains, n: int) -> float:
            return gains.of(n) - regression.price(now.fit.samples, trials[n].width)

        for n in now.chosen:
            if regression.half.runs.budget.over:
                break
            without = regression.solve([k for k in now.chosen if k != n], now.fit.whitening)
            gains = regression.gains(without, [*rest, n])
            lost = worth(gains, n)
            promises += [(worth(gains, k) - lost, n, k) for k in rest]
        for promise, n, k in sorted(promises, reverse=True)[:TRIED]:
            if promise <= 0.0:
                break
            other = self._pruned([k if one == n else one for one in now.chosen])
            if other.evidence > now.evidence + CLEAR:
                return other
        return None

    def _choice(self, chosen: list[int]) -> _Choice:
        fit = self.regression.fit(chosen)
        return _Choice(chosen, fit, self._evidence(fit, self.regression.width(chosen)))

    def _next(self, chosen: list[int], fit: LinearFit) -> tuple[list[int], LinearFit | None]:
        """The trials to add, and the fit with them; None where nothing is worth its price."""
        regression, rest = self.regression, self.regression.rest(chosen)
        if not rest:
            return [], None
        gains = regression.gains(fit, rest)

        def worth(offer: list[int]) -> float:
            return gains.of(*offer) - regression.price(fit.samples, regression.width(offer))

        offers = [max(([n] for n in rest), key=worth)]
        pair = self._pair(gains, rest)
        offers += [list(pair)] if pair and self._synergy(gains, pair, offers[0]) else []
        pick = max(offers, key=worth)
        there = regression.fit([*chosen, *pick], fit.whitening, 2) if worth(pick) > 0.0 else None
        slow, by_slow = self._slow(chosen, fit, rest, pick if there else [])
        if by_slow is not None:
            limit = self._evidence(fit, 0)
            if there is not None:
                limit = max(limit, self._evidence(there, self.regression.width(pick)))
            if self._evidence(by_slow, self.regression.width(slow)) > limit:
                return slow, by_slow
        return pick, there

    def _slow(
        self, chosen: list[int], fit: LinearFit, rest: list[int], pick: list[int]
    ) -> tuple[list[int], LinearFit | None]:
        """The best trial by plain squares, judged with the discrepancy that it leaves itself.

        A level that is missing passes for slow discrepancy, whose whitening then hides it.
        """
        regression = self.regression
        gains = regression.plain_gains(fit, rest)
        ranked = sorted(rest, key=gains.unbounded, reverse=True)
        sound = (n for n in ranked if not regression.impossible(n, gains.free(n)))
        best = next(sound, rest[0])
        if best in pick:
            return [], None
        return [best], regression.fit([*chosen, best], fit.whitening)

    def _evidence(self, fit: LinearFit, width: int) -> float:
        """Log evidence of a fit by its discrepancy's size, less the price of what was added.

        And less what amplitudes cost in their prior sd: a tolerance ten sd off leaves as little as
        a cause in its place (a leg's friction, doubled, that the model knows to 10 %).
        """
        rows = fit.samples / len(fit.whitening.mixing[0])
        _, size = np.linalg.slogdet(fit.whitening.mixing[0])
        cost = float(fit.shares @ fit.shares) + self.regression.price(fit.samples, width)
        return float(rows * size - 0.5 * cost)

    def _pair(self, gains: Gains, rest: list[int]) -> tuple[int, int] | None:
        """The two trials of different causes that take most together."""
        trials = self.regression.trials
        likely = sorted(rest, key=gains.of, reverse=True)[:PAIRED]
        taken = {
            (a, b): both
            for (a, b), both in gains.of_pairs(likely).items()
            if trials[a].cause.label != trials[b].cause.label
        }
        return max(taken, key=lambda pair: taken[pair], default=None)

    @staticmethod
    def _synergy(gains: Gains, pair: tuple[int, int], single: list[int]) -> bool:
        """Whether two together take more than the best alone could announce twice over."""
        return gains.of(*pair) > 2.0 * gains.of(*single)

    def swapped(self, chosen: list[int]) -> list[int]:
        """With the best variant of each cause in place of the one that was chosen, by plain error.

        Whitened by a discrepancy, a friction with a wrong gap can pass for a right one with slow
        error beside it (the damper: gaps of 1 and 6 mm).
        """
        regression = self.regression
        for place, n in enumerate(list(chosen)):
            variants = regression.variants(n)
            if len(variants) < 2:
                continue
            rest = [k for k in chosen if k != n]
            error = {k: regression.plain_error([*rest, k]) for k in variants}
            chosen[place] = min(variants, key=lambda k: error[k])
        return chosen

    def _pruned(self, chosen: list[int]) -> _Choice:
        """Without those that cannot be, and those without which the criterion is better."""
        now = self._choice(self.swapped(list(chosen)))
        while now.chosen:
            losses = losses_of(self.regression, now.fit)
            worst = min(now.chosen, key=lambda n: losses[n])
            fewer = self._choice([n for n in now.chosen if n != worst])
            if losses[worst] >= 0.0 and fewer.evidence <= now.evidence:
                break
            now = fewer
        return now


def losses_of(regression: Regression, fit: LinearFit) -> dict[int, float]:
    """Chi^2 a column that is lost where a chosen trial is taken out; -1 where it cannot be."""
    inverse = np.linalg.inv(fit.hessian)
    found = {}
    for n, at in regression.places(fit.chosen).items():
        shares = fit.shares[at]
        value = float(shares @ np.linalg.solve(inverse[np.ix_(at, at)], shares)) / len(at)
        found[n] = -1.0 if regression.impossible(n, shares) else value
    return found
