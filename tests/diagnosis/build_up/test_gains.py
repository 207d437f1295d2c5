"""Gains: what trials take, alone and together, is what least squares with bounds leave."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from ves_twin.diagnosis.build_up.gains import Gains

PER_TRIAL = (1, 1, 2, 1, 1)
"""Columns of each trial."""


def drawn(widths: tuple[int, ...], reach: float) -> tuple[Gains, np.ndarray, np.ndarray]:
    """Gains of random columns that go along with each other, the columns and the target."""
    rng = np.random.default_rng(4)
    count = sum(widths)
    columns = rng.standard_normal((80, count)) + 0.8 * rng.standard_normal((80, 1))
    target = columns @ rng.standard_normal(count) + rng.standard_normal(80)
    ends = np.cumsum([0, *widths])
    where = {n: np.arange(ends[n], ends[n + 1]) for n in range(len(widths))}
    low, high = np.full(count, -reach), np.full(count, reach)
    return Gains(columns.T @ columns, columns.T @ target, where, low, high), columns, target


def taken(columns: np.ndarray, target: np.ndarray, shares: np.ndarray) -> float:
    """Fall of |y - X a|^2 + |a|^2."""
    left = target - columns @ shares
    return float(target @ target - left @ left - shares @ shares)


@pytest.mark.parametrize("trials", [(0,), (2,), (0, 1), (1, 2), (0, 2, 4)])
def test_what_trials_take_is_the_fall_of_the_squares(trials: tuple[int, ...]) -> None:
    gains, columns, target = drawn(PER_TRIAL, np.inf)
    own = columns[:, np.concatenate([gains.where[n] for n in trials])]
    best = np.linalg.solve(own.T @ own + np.eye(own.shape[1]), own.T @ target)
    assert gains.free(*trials) == pytest.approx(best, rel=1e-9)
    assert gains.of(*trials) == pytest.approx(taken(own, target, best), rel=1e-9)


@pytest.mark.parametrize("reach", [np.inf, 0.05])
@pytest.mark.parametrize("widths", [(1, 1, 1, 1, 1), PER_TRIAL])
def test_all_pairs_at_once_take_what_each_pair_takes(widths: tuple[int, ...], reach: float) -> None:
    gains, columns, target = drawn(widths, reach)
    trials = list(range(len(widths)))
    every = gains.of_pairs(trials)
    assert list(every) == list(combinations(trials, 2))
    for pair, both in every.items():
        own = columns[:, np.concatenate([gains.where[n] for n in pair])]
        free = np.linalg.solve(own.T @ own + np.eye(own.shape[1]), own.T @ target)
        least = taken(own, target, np.clip(free, -reach, reach))
        assert both == pytest.approx(max(least, 0.0), rel=1e-9)


def test_a_trial_takes_no_more_than_its_range_allows() -> None:
    wide, columns, target = drawn((1,), np.inf)
    near, *_ = drawn((1,), 0.3 * abs(float(wide.free(0)[0])))
    share = np.sign(wide.free(0)) * near.high
    assert near.of(0) == pytest.approx(taken(columns, target, share), rel=1e-9)
    assert 0.0 < near.of(0) < wide.of(0)
    assert near.unbounded(0) == pytest.approx(wide.of(0), rel=1e-9)


def test_a_trial_that_would_need_the_other_sign_takes_nothing() -> None:
    wide, *_ = drawn((1,), np.inf)
    sign = -np.sign(wide.free(0))
    low, high = np.minimum(0.0, 9.0 * sign), np.maximum(0.0, 9.0 * sign)
    assert Gains(wide.gram, wide.slope, wide.where, low, high).of(0) == 0.0
