"""Steps of a clock that is written in whole counts: its usual one, and which are gaps."""

from __future__ import annotations

import numpy as np
import pytest

from ves_twin.data.clock.clock_report import ClockCounter, longest_step, rounding, usual_step


def whole(rate: float, count: float = 1e-3, rows: int = 2000) -> np.ndarray:
    return np.asarray(count * np.floor(np.arange(rows) / rate / count + 1e-9))


@pytest.mark.parametrize("rate", [130.0, 300.0, 420.0, 470.0, 700.0, 800.0, 900.0])
def test_rows_in_whole_milliseconds_have_the_mean_step_and_no_gap(rate):
    """At 420 Hz rows were 2 ms apart, each third one a gap of 3 ms."""
    time = whole(rate)
    assert usual_step(time) == pytest.approx(1.0 / rate, rel=2e-3)
    assert np.all(np.diff(time) <= longest_step(np.diff(time), usual_step(time)))


def test_a_row_that_is_lost_is_a_gap_still():
    for time in (whole(420.0), 0.002 * np.arange(2000), np.arange(2000) / 420.0):
        kept = np.delete(time, [700, 701, 702, 1100])
        counter = ClockCounter("t", "s", False, 1.0)
        counter.take(kept)
        assert counter.report().gaps >= 1
        assert counter.report().period == pytest.approx((time[-1] - time[0]) / 1999, rel=2e-3)


def test_one_stamp_off_the_counts_changes_nothing():
    time = whole(700.0)
    time[1000] += 0.0005
    assert usual_step(time) == pytest.approx(1.0 / 700.0, rel=2e-3)


def test_rows_that_are_lost_at_random_are_gaps_and_no_rounding():
    kept = np.random.default_rng(0).random(2000) > 0.25
    steps = np.diff((0.01 * np.arange(2000))[kept])
    assert rounding(steps) == 0.0
    assert usual_step(np.cumsum(steps)) == pytest.approx(0.01)


def test_stamps_with_more_digits_are_not_rounded():
    steps = np.diff(np.arange(500) / 417.3)
    assert rounding(steps) == rounding(np.full(99, 0.01)) == rounding(np.zeros(0)) == 0.0
