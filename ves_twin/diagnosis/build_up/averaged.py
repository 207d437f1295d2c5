"""averaged_half_widths: how far sizes would move if other choices of causes were the right ones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import lgamma

import numpy as np
from scipy.linalg import cho_factor, cho_solve, solve_triangular

from ves_twin.core.types import BoolArray, FloatArray, IntArray
from ves_twin.diagnosis.bank.inner import inner
from ves_twin.diagnosis.build_up.memory import independent_rows
from ves_twin.diagnosis.build_up.regression import BEYOND, Regression
from ves_twin.diagnosis.record.whitening import Whitening

STEPS = 4_000
"""Of the chain: 1 500, 4 000 and 10 000 hold the same share of sizes within 1 % (same cases)."""

SWAPS = 0.4
"""Share of steps that put one cause in the place of another: alone in and out they part seldom."""

ROUNDING = 1e-9
"""Of a column's square, added to what nuisances leave of it: they may leave nothing."""

BURNT, EVERY = 0.2, 5
"""Share of the steps that is thrown away, and steps from one draw to the next."""


@dataclass(frozen=True)
class _Chain:
    """Choices of causes, each as probable as its evidence: nuisances are integrated out.

    Attributes:
        gram, slope: of all candidate columns, nuisances taken out (k, k) and (k,).
        places: columns of each candidate.
        spread: prior sd of every amplitude.
        low, high: amplitudes beyond which no machine is (k,).
    """

    gram: FloatArray
    slope: FloatArray
    places: list[IntArray]
    spread: float
    low: FloatArray
    high: FloatArray

    def drawn(self, start: BoolArray, rng: np.random.Generator) -> FloatArray:
        """Amplitudes (draws, k) along a chain that begins at a choice; nan where not chosen."""
        chosen, found = start.copy(), list[FloatArray]()
        log_odds, here = self._posterior(chosen)
        for step in range(STEPS):
            other = self._other(chosen, rng)
            worth, there = self._posterior(other)
            if np.isfinite(worth) and np.log(rng.random()) < worth - log_odds:
                chosen, log_odds, here = other, worth, there
            if step >= BURNT * STEPS and step % EVERY == 0:
                found.append(self._draw(chosen, here, rng))
        return np.array(found)

    def _other(self, chosen: BoolArray, rng: np.random.Generator) -> BoolArray:
        """With one cause more or less, or one in the place of another."""
        other, n = chosen.copy(), int(rng.integers(len(chosen)))
        if rng.random() < SWAPS and chosen.any() and not chosen.all():
            n = int(rng.choice(np.flatnonzero(chosen)))
            other[int(rng.choice(np.flatnonzero(~chosen)))] = True
        other[n] = not other[n]
        return other

    def _columns(self, chosen: BoolArray) -> IntArray:
        parts = [at for at, there in zip(self.places, chosen, strict=True) if there]
        return np.concatenate(parts).astype(int) if parts else np.zeros(0, int)

    def _posterior(self, chosen: BoolArray) -> tuple[float, tuple[FloatArray, FloatArray]]:
        """Log odds of a choice, none if it cannot be; root of the precision, and whitened mean."""
        at = self._columns(chosen)
        precision = self.gram[np.ix_(at, at)] + np.eye(len(at)) / self.spread**2
        root = np.asarray(np.linalg.cholesky(precision), float)
        whitened = np.asarray(solve_triangular(root, self.slope[at], lower=True), float)
        likeliest = solve_triangular(root.T, whitened)
        if np.any(likeliest < self.low[at]) or np.any(likeliest > self.high[at]):
            return -np.inf, (root, whitened)
        volume = np.sum(np.log(np.diag(root))) + len(at) * np.log(self.spread)
        log_odds = 0.5 * whitened @ whitened - volume + self._prior(int(np.sum(chosen)))
        return float(log_odds), (root, whitened)

    def _prior(self, count: int) -> float:
        """Log of how likely a choice is by its number: any number of causes is as likely as any.

        One more beside k of m has odds of (k + 1) / (m - k): they grow with what is proved.
        """
        rest = len(self.places) - count
        return lgamma(count + 1.0) + lgamma(rest + 1.0) - lgamma(len(self.places) + 1.0)

    def _draw(
        self, chosen: BoolArray, here: tuple[FloatArray, FloatArray], rng: np.random.Generator
    ) -> FloatArray:
        root, whitened = here
        found = np.full(len(self.slope), np.nan)
        noise = rng.standard_normal(len(whitened))
        found[self._columns(chosen)] = solve_triangular(root.T, whitened + noise)
        return found


def averaged_half_widths(
    regression: Regression,
    proved: Sequence[int],
    whitening: Whitening,
    residual: FloatArray,
    confidence: float,
) -> dict[str, float]:
    """Half widths of sizes over choices of causes, each weighed by its evidence.

    An interval of one choice counts noise and model error, not the causes that held-out rows did
    not prove and that would share the record with it: viscous friction takes the place of a
    quadratic drag that stays hidden. A Markov chain over choices draws sizes with and without
    them; told is how far a share `confidence` of the draws lies from the size of the choice that
    is proved. Each channel counts as many rows as are independent.

    Source: Madigan and York 1995, Bayesian graphical models for discrete data (the chain); Hoeting,
    Madigan, Raftery and Volinsky 1999, Bayesian model averaging; Scott and Berger 2010, Bayes and
    empirical-Bayes multiplicity adjustment (the prior of a choice).

    Args:
        regression: linear about the fit.
        proved: numbers of its trials.
        whitening: that sizes were fitted with.
        residual: what the fit leaves (rows, c).
        confidence: of the intervals.

    Returns:
        Parameter -> half width [its unit]; none of a trial whose sizes share one column.
    """
    if not proved:
        return {}
    design, target = _tempered(regression, whitening, residual)
    first = regression.half.fixed
    gram, slope = _without(design, target, first)
    where = regression.places(range(len(regression.trials)))
    own = np.concatenate([where[n] - first for n in proved])
    alone = np.linalg.solve(gram[np.ix_(own, own)] + 1e-6 * np.eye(len(own)), slope[own])
    spread = float(np.sqrt(np.mean(np.square(alone))))
    candidates = _candidates(regression, proved, gram, slope - gram[:, own] @ alone, first)
    low, high = (BEYOND * np.concatenate([at[k] for at in regression.limits]) for k in (0, 1))
    places = [where[n] - first for n in candidates]
    chain = _Chain(gram, slope, places, max(spread, 1e-9), low, high)
    drawn = chain.drawn(np.isin(candidates, proved), np.random.default_rng(0))
    off = np.full(len(slope), np.nan)
    off[own] = alone
    return _in_units(regression, proved, drawn - off, first, confidence)


def _tempered(
    regression: Regression, whitening: Whitening, residual: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Design (samples, k) in prior sd and target, weighed as if rows were independent."""
    columns, scale = regression.design(range(len(regression.trials)))
    width = residual.shape[1]
    rows = np.maximum(np.sum(regression.half.kept, axis=0), 1)
    squares = np.square(whitening.apply(residual.astype(np.float32)).reshape(-1, width))
    level = np.maximum(np.sum(squares, axis=0) / rows, 1e-12)
    share = np.minimum(independent_rows(regression.half.runs, residual) / rows, 1.0)
    weight = np.tile(np.sqrt(share / level), len(squares))
    design = regression.whitened(whitening, columns) * scale * weight[:, None]
    target = whitening.apply(regression.half.target.astype(np.float32)) * weight
    return np.asarray(design, float), np.asarray(target, float)


def _without(design: FloatArray, target: FloatArray, first: int) -> tuple[FloatArray, FloatArray]:
    """Gram matrix and slope of all columns but the first, those taken out as nuisances."""
    gram, slope = inner(design, design), design.T @ target
    factor = cho_factor(gram[:first, :first] + np.eye(first))
    cross = gram[:first, first:]
    left = gram[first:, first:] - cross.T @ cho_solve(factor, cross)
    left = 0.5 * (left + left.T) + ROUNDING * np.diag(np.diag(gram)[first:])
    return left, slope[first:] - cross.T @ cho_solve(factor, slope[:first])


def _candidates(
    regression: Regression, proved: Sequence[int], gram: FloatArray, left: FloatArray, first: int
) -> list[int]:
    """One trial of each cause: the proved one, else the one that takes most beside the proved."""
    found = {regression.trials[n].cause.label: (np.inf, n) for n in proved}
    for n, at in regression.places(range(len(regression.trials))).items():
        own = at - first
        share = float(left[own] @ left[own]) / max(float(np.trace(gram[np.ix_(own, own)])), 1e-12)
        label = regression.trials[n].cause.label
        if share > found.get(label, (-1.0, n))[0]:
            found[label] = (share, n)
    return [n for _, n in found.values()]


def _in_units(
    regression: Regression,
    proved: Sequence[int],
    apart: FloatArray,
    first: int,
    confidence: float,
) -> dict[str, float]:
    """How far a share of the draws lies from the proved sizes, in the parameters' units."""
    where, found = regression.places(range(len(regression.trials))), {}
    for n in proved:
        trial, at = regression.trials[n], where[n] - first
        if len(at) != len(trial.cause.parameters):
            continue
        drawn = apart[~np.isnan(apart[:, at[0]])][:, at]
        if not len(drawn):
            continue
        far = np.quantile(np.abs(drawn), confidence, axis=0) * regression.prior[n]
        for name, size in zip(trial.cause.parameters, np.abs(trial.departures(far)), strict=True):
            found[name] = float(size)
    return found
