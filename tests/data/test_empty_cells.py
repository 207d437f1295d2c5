"""Empty rows that a line may stand for."""

import numpy as np
import pytest

from ves_twin.data.empty_cells import FEW, filled, lone


@pytest.mark.parametrize("start", [0, 3, 20])
def test_a_few_empty_rows_together_are_read_over_and_more_are_a_gap(start):
    empty = np.zeros(40, bool)
    empty[start : start + FEW] = True
    assert np.array_equal(lone(empty), empty)
    empty[start + FEW] = True
    assert not lone(empty).any()


def test_each_stretch_counts_by_itself():
    empty = np.zeros(40, bool)
    empty[[2, 5, 6, 39]] = True
    empty[10:30] = True
    assert list(np.flatnonzero(lone(empty))) == [2, 5, 6, 39]


@pytest.mark.parametrize(("held", "wanted"), [(False, [1, 2, 3, 4, 4]), (True, [1, 1, 1, 4, 4])])
def test_what_is_missing_is_straight_between_its_neighbours_or_as_it_was(held, wanted):
    values = np.array([1.0, np.nan, np.nan, 4.0, np.nan])
    assert list(filled(values, ~np.isfinite(values), held)) == wanted
