"""The linearised region of a calibration against regions that can be drawn by hand."""

import numpy as np
import pytest

from ves_twin.procedures.stability.feasible import Feasible


def band(value: float, low: float, high: float, slope: np.ndarray) -> Feasible:
    """One claim low <= value + slope d <= high."""
    margins = np.array([value - low, high - value])
    return Feasible(("a >=", "a <="), margins, np.array([slope, -slope]))


def test_step_goes_to_the_middle_of_a_band():
    region = band(3.0, 0.0, 1.0, np.array([2.0]))
    step = region.step(np.array([-9.0]), np.array([9.0]), 9.0)
    assert 3.0 + 2.0 * step[0] == pytest.approx(0.5)


def test_step_stays_within_reach_and_range():
    region = band(3.0, 0.0, 1.0, np.array([2.0]))
    assert region.step(np.array([-9.0]), np.array([9.0]), 0.1)[0] == pytest.approx(-0.1)
    assert region.step(np.array([-0.05]), np.array([9.0]), 0.1)[0] == pytest.approx(-0.05)


def test_number_that_matters_nothing_stays():
    region = band(3.0, 0.0, 1.0, np.array([2.0, 0.0]))
    assert region.step(np.full(2, -9.0), np.full(2, 9.0), 9.0)[1] == pytest.approx(0.0)


def test_comfortable_margins_ask_for_no_step():
    region = band(5.0, 0.0, 10.0, np.array([1.0]))
    assert region.step(np.array([-9.0]), np.array([9.0]), 9.0)[0] == pytest.approx(0.0)


def test_width_is_the_range_in_which_all_claims_hold():
    region = band(0.25, 0.0, 1.0, np.array([0.5]))
    assert region.width(0) == pytest.approx((-0.5, 1.5))
    assert np.isnan(band(2.0, 0.0, 1.0, np.array([0.5])).width(0)).all()


def test_conflict_is_between_claims_not_within_one():
    rows = np.array([[1.0, 0.0], [-1.0, 0.0], [-0.9, 0.1]])
    region = Feasible(("a >=", "a <=", "b >="), np.ones(3), rows)
    ((one, other, cosine),) = region.conflicts()
    assert (one, other) == ("a >=", "b >=")
    assert cosine == pytest.approx(-0.9 / np.hypot(0.9, 0.1))
