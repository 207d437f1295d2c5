"""Which of two choices of causes is kept: by what both leave, less the price of what they hold."""

import numpy as np
import pytest
from linear import PERIOD, Linear, halves
from scipy.signal import lfilter

from ves_twin.diagnosis.build_up.memory import independent_rows, memory
from ves_twin.diagnosis.build_up.offer import Offer, preferred

FEW, MANY = [0, 1], [0, 1, 2, 3, 4, 5]


@pytest.fixture(scope="module")
def regression():
    return halves(Linear(), {"viscous@a:size": 0.6}, 3).regression


def offer(regression, chosen, residual):
    rms = np.maximum(regression.half.rms(residual), 1e-30)
    return Offer(chosen, None, None, residual, rms)


def coloured(regression, memory_rows, seed):
    rows = len(regression.half.target)
    share = np.exp(-1.0 / memory_rows)
    noise = np.random.default_rng(seed).standard_normal((rows + 500, 2))
    return np.sqrt(1.0 - share**2) * lfilter([1.0], [1.0, -share], noise, axis=0)[500:]


def test_of_two_that_leave_the_same_fewer_causes_are_preferred(regression):
    left = coloured(regression, 10.0, 1)
    some, more = offer(regression, FEW, left), offer(regression, MANY, left)
    assert preferred(regression, [more, some]) is some


@pytest.mark.parametrize("seed", range(3))
def test_causes_that_take_no_more_than_chance_are_not_worth_their_price(regression, seed):
    left = coloured(regression, 10.0, seed)
    some, more = offer(regression, FEW, left), offer(regression, MANY, 0.98 * left)
    assert preferred(regression, [some, more]) is some


def test_causes_that_halve_what_is_left_are_worth_their_price(regression):
    left = coloured(regression, 10.0, 1)
    some, more = offer(regression, FEW, left), offer(regression, MANY, 0.5 * left)
    assert preferred(regression, [some, more]) is more


def test_slow_error_below_a_row_s_noise_is_judged_by_all_of_it(regression):
    """It is a fifth of the declared noise of a row, and smooth over hundreds of them."""
    time = PERIOD * np.arange(len(regression.half.target))
    tones = [np.sin(w * time + p) for w, p in ((0.7, 0.2), (1.1, 1.0), (1.6, 2.0), (2.3, 0.5))]
    slow = 0.002 * np.column_stack([sum(tones[:3]), sum(tones[1:])])
    some, more = offer(regression, FEW, slow), offer(regression, [*FEW, 2], 0.1 * slow)
    assert preferred(regression, [some, more]) is more


def test_what_shows_one_step_ahead_alone_is_not_worth_its_price(regression):
    """Few rows of slow error are independent: they say little of what is small and faster."""
    slow, fast = coloured(regression, 150.0, 1), coloured(regression, 2.0, 2)
    some, more = offer(regression, FEW, slow + 0.3 * fast), offer(regression, [*FEW, 2], slow)
    assert preferred(regression, [some, more]) is some
    assert preferred(regression, [some, offer(regression, [*FEW, 2], 0.3 * fast)]).chosen[-1] == 2


def test_memory_of_a_first_order_colour_is_its_closed_form():
    """1/2 + sum of exp(-k/T) over k is 1/2 + 1/(exp(1/T) - 1), T to its cut at 5 %."""
    share, rows = np.exp(-1.0 / 10.0), 200_000
    noise = np.random.default_rng(5).standard_normal(rows)
    told = memory(lfilter([1.0], [1.0, -share], noise))
    assert told == pytest.approx(0.5 + share / (1.0 - share), rel=0.1)


def test_independent_rows_of_white_noise_are_all_of_them(regression):
    runs = regression.half.runs
    rows = len(regression.half.target)
    white = np.random.default_rng(2).standard_normal((rows, 2))
    assert independent_rows(runs, white) == pytest.approx([rows, rows], rel=0.1)
