"""Which of several choices of causes is kept: by what they leave of held-out rows."""

from types import SimpleNamespace

import numpy as np
import pytest
from linear import Linear, halves
from scipy.signal import lfilter

from ves_twin.diagnosis.build_up.memory import independent_rows, memory
from ves_twin.diagnosis.build_up.offer import Offer, preferred


@pytest.fixture(scope="module")
def both():
    return halves(Linear(), {"viscous@a:size": 0.6}, 3)


@pytest.fixture(scope="module")
def regression(both):
    return both.regression


def offer(both, residual, dropped=None):
    proof = SimpleNamespace(dropped=dropped or {})
    return Offer(both, None, proof, None, frozenset(), residual)


def coloured(regression, memory_rows, seed):
    rows = len(regression.half.target)
    share = np.exp(-1.0 / memory_rows)
    noise = np.random.default_rng(seed).standard_normal((rows + 500, 2))
    return np.sqrt(1.0 - share**2) * lfilter([1.0], [1.0, -share], noise, axis=0)[500:]


def test_the_choice_that_leaves_less_of_held_out_rows_is_kept(both, regression):
    left = coloured(regression, 10.0, 1)
    some, more = offer(both, left), offer(both, 0.9 * left)
    assert preferred([some, more]) is more
    assert preferred([more, some]) is more


def test_of_two_that_leave_the_same_the_first_is_kept(both, regression):
    left = coloured(regression, 10.0, 1)
    first, second = offer(both, left), offer(both, left.copy())
    assert preferred([first, second]) is first


def test_a_channel_whose_error_is_slow_says_less_than_one_of_many_independent_rows(
    both, regression
):
    slow, fast = coloured(regression, 150.0, 1)[:, :1], coloured(regression, 2.0, 2)[:, 1:]
    one = offer(both, np.hstack([0.5 * slow, fast]))
    other = offer(both, np.hstack([slow, 0.8 * fast]))
    assert preferred([one, other]) is other


def test_rows_that_were_not_measured_say_nothing(both, regression):
    left = coloured(regression, 10.0, 1)
    rows = np.zeros((len(left), 1), bool)
    rows[: len(rows) // 2] = True
    held = SimpleNamespace(
        runs=SimpleNamespace(slices=both.held.runs.slices, kept=~np.repeat(rows, 2, axis=1)),
        rms=lambda values: np.sqrt(np.mean(values[~rows[:, 0]] ** 2, axis=0)),
    )
    part = SimpleNamespace(held=held, regression=regression)
    wild = np.where(rows, 100.0, 0.9) * left
    assert preferred([offer(part, left), offer(part, wild)]).held_out is wild


def test_causes_that_held_out_rows_speak_against_are_rejected(both, regression):
    labels = [trial.cause.label for trial in regression.trials]
    told = offer(both, np.zeros_like(regression.half.target), {0: 1.0, 1: 0.3})
    assert told.rejected == {labels[0]}


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
