"""jumps and spikes: what no mechanism does to a place, and what it does."""

from __future__ import annotations

import numpy as np
import pytest

from ves_twin.data.quality.jumps import jumps
from ves_twin.data.quality.spikes import spikes

TIME = 0.01 * np.arange(600)
SWING = 1.0 + 0.3 * np.sin(2.0 * TIME) + 1e-4 * np.random.default_rng(0).standard_normal(600)


def put_on(row: int, size: float) -> np.ndarray:
    return SWING + size * (np.arange(600) > row)


@pytest.mark.parametrize("size", [0.5, -3.0])
@pytest.mark.parametrize("row", [20, 300, 590])
def test_two_runs_behind_each_other_are_found_at_their_seam(size, row):
    assert jumps(put_on(row, size), TIME) == (row,)


@pytest.mark.parametrize(
    "column",
    [
        SWING,
        np.round(SWING, 2),
        np.where(np.arange(600) // 40 % 2, SWING, SWING + 2.0),  # it goes to and fro like that
        np.interp(TIME, [0, 2, 2.04, 2.3, 6], [0, 0.01, 3, 3, 3.2]),  # a fast move
        SWING + 3.0 * (np.arange(600) == 300),
        SWING + 3.0 * ((np.arange(600) >= 300) & (np.arange(600) < 306)),  # a dropout
        np.cumsum(np.random.default_rng(1).standard_normal(600)),
        np.full(600, 2.0),
        np.full(600, np.nan),
        np.arange(8.0),
    ],
)
def test_what_a_machine_or_a_sensor_does_otherwise_is_no_seam(column):
    assert jumps(column, TIME[: len(column)]) == ()


def test_a_place_that_rests_moves_where_it_is_asked_to_or_again_and_again():
    rests = 1e-4 * np.sin(np.arange(600.0)) + (np.arange(600) > 300)
    asked = np.where(np.arange(600) > 298, 5.0, 2.0)
    assert jumps(rests, TIME) == (300,)
    assert jumps(rests, TIME, [asked]) == ()
    assert jumps(rests, TIME, [asked[::-1] * 0.0 + np.arange(600.0)]) == (300,)
    assert jumps(rests + (np.arange(600) > 450), TIME) == ()


def test_a_step_over_rows_that_are_missing_is_none():
    kept = np.r_[0:100, 160:600]
    assert jumps(SWING[kept], TIME[kept]) == ()
    assert jumps(SWING[kept], TIME[: len(kept)]) == (99,)


def test_single_rows_far_from_their_neighbours_are_found_and_steps_are_not():
    column = SWING.copy()
    column[[100, 400]] += [2.0, -0.5]
    assert spikes(column) == (100, 400)
    assert spikes(put_on(300, 3.0)) == spikes(SWING) == spikes(np.full(600, np.nan)) == ()
