"""The one comparison: laws that hold for every kind of tolerance."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ves_twin.thesis.tolerance import Comparison, Tolerance

NUMBERS = st.floats(-1e6, 1e6)
LIMITS = st.floats(0.0, 1e3)
LISTS = st.lists(NUMBERS, min_size=1, max_size=8)
DEVIATING = [Comparison.ABSOLUTE, Comparison.RELATIVE]


def met(tolerance, values, expected=(), holds=None):
    return tolerance.met(values, expected, holds)


@given(LISTS, st.sampled_from([*DEVIATING, Comparison.EXACT]), LIMITS)
def test_what_is_expected_meets_every_tolerance(values, kind, limit):
    assert met(Tolerance(kind, (limit,)), values, values)


@given(LISTS, LISTS, st.sampled_from(DEVIATING), LIMITS, LIMITS)
def test_a_wider_tolerance_never_turns_met_into_missed(values, expected, kind, limit, more):
    if met(Tolerance(kind, (limit,)), values, expected):
        assert met(Tolerance(kind, (limit + more,)), values, expected)


@given(LISTS, NUMBERS, NUMBERS)
def test_an_interval_is_at_least_and_at_most(values, low, high):
    both = met(Tolerance(Comparison.AT_LEAST, (low,)), values) and met(
        Tolerance(Comparison.AT_MOST, (high,)), values
    )
    assert met(Tolerance(Comparison.INTERVAL, low=low, high=high), values) == both


@given(LISTS, st.integers(0, 7), st.floats(1.01, 10.0))
def test_one_value_outside_is_enough_to_miss(values, index, factor):
    moved = list(values)
    moved[index % len(values)] += 2.0 * factor
    assert not met(Tolerance(Comparison.ABSOLUTE, (2.0,)), moved, values)


@given(LISTS, st.sampled_from(list(Comparison)))
def test_what_is_not_finite_or_missing_or_denied_is_missed(values, kind):
    tolerance = Tolerance(kind, (1e9,) if kind is not Comparison.AT_LEAST else (-1e9,))
    if kind is not Comparison.EVENT:
        assert met(tolerance, values, values)
        for bad in (math.nan, math.inf):
            assert not met(tolerance, [*values[1:], bad], values)
        assert not met(tolerance, [], values)
    assert not met(tolerance, values, values, holds=False)


def test_an_event_must_have_happened():
    event = Tolerance(Comparison.EVENT)
    assert met(event, (), holds=True)
    assert not met(event, ())
    assert not met(event, (1.0,), (1.0,))


@pytest.mark.parametrize("expected", [(), (1.0,), (1.0, 2.0, 3.0)])
def test_values_are_compared_one_by_one_only(expected):
    """One expected value for two found ones is no comparison."""
    assert not met(Tolerance(Comparison.ABSOLUTE, (1e9,)), (1.0, 2.0), expected)


def test_limits_may_differ_from_value_to_value():
    tolerance = Tolerance(Comparison.ABSOLUTE, (0.1, 10.0))
    assert met(tolerance, (1.05, 5.0), (1.0, 0.0))
    assert not met(tolerance, (1.05, 11.0), (1.0, 0.0))
    assert not met(tolerance, (1.2, 5.0), (1.0, 0.0))
