"""change_of: whether sizes on different days are constant, and if not, since when and how."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from scipy.optimize import brentq
from scipy.stats import chi2, norm

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.trend.false_alarms import Limits
from ves_twin.diagnosis.trend.joint import directions
from ves_twin.diagnosis.trend.shapes import Kind, Shapes

SHUFFLES = 4000
"""Permutations of the days, where sizes scatter from day to day."""

DOUBT = 0.1
"""Probability from which the other shape is told beside the better one."""


class Course(StrEnum):
    """How a size goes over the days."""

    CONSTANT = "constant"
    STEP = "step"
    RAMP = "ramp"
    VARIES = "varies"


@dataclass(frozen=True)
class Interval:
    """A value and its interval."""

    value: float
    low: float
    high: float


@dataclass(frozen=True)
class Change:
    """What became of a size.

    Attributes:
        course: constant, a step, a ramp, or varying from day to day without a trend.
        statistic: chi^2 that the best change takes away.
        threshold: that it passes by chance with half the stated rate.
        differs: chi^2 that a size of its own on each day takes away.
        differs_threshold: that it passes by chance with the other half.
        scatter: sd from day to day beyond what each recording's own interval says.
        permutation: share of shuffled days with a change as good; None where sizes scatter no more
            than their intervals say.
        onset: date of the change [days]: of a step the first recording that has it and the ends of
            the gaps it may lie in; of a ramp where it begins.
        before, after: size until the onset, and at the last recording.
        slope: of a ramp [unit per day].
        other: probability that it is the other shape, given that it is one of the two.
    """

    course: Course
    statistic: float
    threshold: float
    differs: float
    differs_threshold: float
    scatter: float = 0.0
    permutation: float | None = None
    onset: Interval | None = None
    before: Interval | None = None
    after: Interval | None = None
    slope: Interval | None = None
    other: float = 0.0


@dataclass(frozen=True)
class _Fits:
    """All changes fitted to sizes of a covariance by least squares."""

    shapes: Shapes
    sizes: FloatArray
    covariance: FloatArray

    @property
    def power(self) -> FloatArray:
        return np.asarray(np.linalg.inv(self.covariance))

    def constant(self) -> float:
        """chi^2 about the best constant."""
        power, one = self.power, np.ones(len(self.sizes))
        score = float(one @ power @ self.sizes)
        return float(self.sizes @ power @ self.sizes) - score**2 / float(one @ power @ one)

    def falls(self) -> FloatArray:
        """chi^2 that each change takes off (m,)."""
        power = self.power
        return np.asarray((directions(power, self.shapes.columns) @ power @ self.sizes) ** 2)

    def coefficients(self, column: int) -> tuple[FloatArray, FloatArray]:
        """Constant and change, and their covariance."""
        design = np.stack([np.ones(len(self.sizes)), self.shapes.columns[column]], axis=1)
        spread = np.linalg.inv(design.T @ self.power @ design)
        return spread @ design.T @ self.power @ self.sizes, spread


def change_of(
    days: FloatArray,
    sizes: FloatArray,
    covariance: FloatArray,
    limits: Limits,
    confidence: float = 0.90,
    seed: int = 0,
) -> Change:
    """Hold sizes against a constant, a step and a ramp.

    A change is claimed where it takes more than its limit off chi^2. Where sizes scatter more
    about the best change than their covariance says, days differ by themselves: that scatter is
    then estimated, and a change claimed only if fewer than alpha of all orders of the days have one
    as good.

    Args:
        days: dates, rising [days] (n,).
        sizes: (n,).
        covariance: of the sizes (n, n).
        limits: with the stated rate of false alarms.
        confidence: of intervals.
        seed: of the shuffles.
    """
    shapes, alpha = Shapes(days), 0.5 * limits.alpha
    fits = _Fits(shapes, sizes, covariance)
    whole, falls = fits.constant(), fits.falls()
    best, freedom = float(np.max(falls)), len(days) - 3
    found = Change(Course.CONSTANT, best, limits.change, whole, limits.varies)
    if best <= limits.change and whole <= limits.varies:
        return replace(found, before=_mean(fits, confidence))
    scattered = whole - best > chi2.isf(alpha, freedom) if freedom > 0 else False
    if best > limits.change and not scattered:
        return _described(fits, found, confidence)
    share = _shuffled(fits, np.random.default_rng(seed)) if best > limits.change else None
    changed = share is not None and share <= alpha
    scatter = _scatter(fits, freedom, int(np.argmax(falls)) if changed else None)
    wide = _Fits(shapes, sizes, covariance + scatter**2 * np.eye(len(days)))
    found = replace(found, scatter=scatter, permutation=share)
    if changed:
        return _described(wide, found, confidence)
    return replace(found, course=Course.VARIES, before=_mean(wide, confidence))


def _scatter(fits: _Fits, freedom: int, column: int | None) -> float:
    """Sd that, added to each size, makes what a change (else a constant) leaves its freedom."""
    freedom = freedom if column is not None else len(fits.sizes) - 1

    def excess(sd: float) -> float:
        wide = _Fits(fits.shapes, fits.sizes, fits.covariance + sd**2 * np.eye(len(fits.sizes)))
        left = wide.constant() - (0.0 if column is None else float(wide.falls()[column]))
        return left - freedom

    top = 2.0 * float(np.ptp(fits.sizes))
    return float(brentq(excess, 0.0, top)) if excess(0.0) > 0.0 > excess(top) else 0.0


def _shuffled(fits: _Fits, rng: np.random.Generator) -> float:
    """Share of the orders of the days that have a change as good as the true one."""
    scatter = _scatter(fits, 0, None)
    wide = _Fits(fits.shapes, fits.sizes, fits.covariance + scatter**2 * np.eye(len(fits.sizes)))
    rows = directions(wide.power, fits.shapes.columns) @ wide.power
    orders = rng.permuted(np.tile(fits.sizes, (SHUFFLES, 1)), axis=1)
    found = np.max((orders @ rows.T) ** 2, axis=1)
    here = float(np.max((rows @ fits.sizes) ** 2))
    return float((1 + np.count_nonzero(found >= here * (1.0 - 1e-9))) / (1 + SHUFFLES))


def _mean(fits: _Fits, confidence: float) -> Interval:
    power = fits.power
    value = float(np.sum(power @ fits.sizes) / np.sum(power))
    return _interval(value, float(1.0 / np.sqrt(np.sum(power))), confidence)


def _interval(value: float, sd: float, confidence: float) -> Interval:
    reach = float(norm.isf(0.5 * (1.0 - confidence))) * sd
    return Interval(value, value - reach, value + reach)


def _described(fits: _Fits, found: Change, confidence: float) -> Change:
    """The better shape with its onset, sizes and slope."""
    shapes, falls = fits.shapes, fits.falls()
    weights = np.exp(0.5 * (falls - np.max(falls)))
    gaps = np.diff(shapes.stops)
    step = weights[shapes.rows(Kind.STEP)] * gaps / np.sum(gaps)
    ramp = weights[shapes.rows(Kind.RAMP)] / max(len(shapes.ramps), 1)
    total = float(np.sum(step) + np.sum(ramp))
    kind = Kind.STEP if np.sum(step) >= np.sum(ramp) else Kind.RAMP
    own = step if kind is Kind.STEP else ramp
    share = own / np.sum(own)
    columns = range(shapes.rows(kind).start, shapes.rows(kind).stop)
    parts = [fits.coefficients(column) for column in columns]
    ends = [float(shapes.columns[column][-1]) for column in columns]
    before = _mixed(parts, share, [(1.0, 0.0)] * len(parts), confidence)
    after = _mixed(parts, share, [(1.0, end) for end in ends], confidence)
    slope = _mixed(parts, share, [(0.0, 1.0)] * len(parts), confidence)
    return replace(
        found,
        course=Course(kind.value),
        onset=_onset(shapes, kind, own, confidence),
        before=before,
        after=after,
        slope=slope if kind is Kind.RAMP else None,
        other=float(1.0 - np.sum(own) / total),
    )


def _mixed(
    parts: list[tuple[FloatArray, FloatArray]],
    share: FloatArray,
    rows: list[tuple[float, float]],
    confidence: float,
) -> Interval:
    """A combination of constant and change, over the dates on which the change may have begun."""
    values = np.array([np.dot(row, part[0]) for row, part in zip(rows, parts, strict=True)])
    spreads = np.array([np.array(r) @ p[1] @ np.array(r) for r, p in zip(rows, parts, strict=True)])
    mean = float(share @ values)
    return _interval(mean, float(np.sqrt(share @ (spreads + (values - mean) ** 2))), confidence)


def _onset(shapes: Shapes, kind: Kind, weights: FloatArray, confidence: float) -> Interval:
    """Most probable date and the shortest stretch of dates around it that holds `confidence`."""
    share = weights / np.sum(weights)
    low = high = int(np.argmax(share))
    while np.sum(share[low : high + 1]) < confidence:
        left = share[low - 1] if low > 0 else -1.0
        right = share[high + 1] if high + 1 < len(share) else -1.0
        low, high = (low - 1, high) if left >= right else (low, high + 1)
    if kind is Kind.STEP:
        best = int(np.argmax(share))
        return Interval(
            float(shapes.steps[best]), float(shapes.stops[low]), float(shapes.steps[high])
        )
    dates = shapes.ramps
    return Interval(float(dates[int(np.argmax(share))]), float(dates[low]), float(dates[high]))
