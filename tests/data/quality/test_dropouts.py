"""dropouts: what stands far off for some rows and comes back, and what a machine does itself."""

from __future__ import annotations

import numpy as np
import pytest

from ves_twin.data.quality.dropouts import dropouts

TIME = 0.01 * np.arange(600)
SWING = 1.0 + 0.3 * np.sin(2.0 * TIME) + 1e-4 * np.random.default_rng(0).standard_normal(600)


def lost(first: int, count: int, value: float = 0.0) -> np.ndarray:
    found = SWING.copy()
    found[first : first + count] = value
    return found


@pytest.mark.parametrize("count", [2, 3, 7, 25])
@pytest.mark.parametrize("value", [0.0, 5.0])
def test_a_reading_at_one_value_far_off_is_found_with_its_rows(count, value):
    assert dropouts(lost(200, count, value)) == (slice(200, 200 + count),)


@pytest.mark.parametrize(("value", "found"), [(0.0, True), (5.0, False)])
def test_a_single_row_is_one_at_zero_alone(value, found):
    """Another one may be an impact."""
    assert bool(dropouts(lost(200, 1, value))) is found


def test_several_are_found_and_rows_without_a_number_are_none():
    column = lost(100, 4)
    column[300:304], column[500:510] = 0.0, np.nan
    assert dropouts(column) == (slice(100, 104), slice(300, 304))


def test_rows_that_were_read_at_even_steps_between_those_of_the_log_are_found_too():
    column = lost(200, 6)
    column[200] = 0.5 * column[199]
    assert [(one.start, one.stop) for one in dropouts(column)] == [(200, 206)]


@pytest.mark.parametrize(
    "column",
    [
        SWING,
        lost(200, 120),  # another state of the machine, not a few rows
        np.where(TIME > 3.0, SWING + 2.0, SWING),  # an offset that stays
        np.round(2.0 * np.sin(3.0 * TIME)),  # a switch
        np.sign(np.sin(9.0 * TIME)) + SWING,  # a square wave
        np.interp(TIME, [0, 2, 2.04, 2.06, 2.1, 6], [0, 0.01, 3, 3, 0.01, 0]),  # a fast move
        np.where((TIME % 0.6) < 0.04, 3.0, SWING),  # a stroke that is held, again and again
        SWING + np.where(np.arange(600) == 300, 3.0, 0.0) + np.where(np.arange(600) == 301, 1.5, 0),
        np.full(600, 2.0),
        np.full(600, np.nan),
    ],
)
def test_what_a_machine_does_is_no_dropout(column):
    assert dropouts(column) == ()
