"""inner: the products of columns that are nothing in most stretches are those of all rows."""

import numpy as np
import pytest

from ves_twin.diagnosis.bank.inner import STRETCH, inner


def _columns(rng: np.random.Generator, samples: int, pieces: int) -> np.ndarray:
    """Two columns of each piece alone, and three of all (samples, 2 pieces + 3)."""
    found = rng.standard_normal((samples, 2 * pieces + 3))
    piece = np.arange(samples) * pieces // samples
    for n in range(2 * pieces):
        found[piece != n // 2, n] = 0.0
    return found


@pytest.mark.parametrize("samples", [5 * STRETCH, 5 * STRETCH + 7, 40])
def test_products_by_stretches_are_those_of_all_rows(samples):
    rng = np.random.default_rng(3)
    one, two = _columns(rng, samples, 4), _columns(rng, samples, 5)
    rounding = 1e-12 * samples  # of a sum of so many numbers of about one
    np.testing.assert_allclose(inner(one, two), one.T @ two, atol=rounding)
    np.testing.assert_allclose(inner(one, one), one.T @ one, atol=rounding)


def test_of_columns_that_are_something_everywhere_nothing_changes():
    rng = np.random.default_rng(4)
    one = rng.standard_normal((3 * STRETCH, 6))
    assert np.array_equal(inner(one, one), one.T @ one)
    assert inner(one, one[:, :0]).shape == (6, 0)


def test_nothing_is_multiplied_where_columns_are_nothing():
    """A number that is none, in a row that no column of the other side has, does not spread."""
    one, two = np.zeros((2 * STRETCH, 1)), np.zeros((2 * STRETCH, 1))
    one[:STRETCH], two[:STRETCH], two[STRETCH:] = 1.0, 2.0, np.nan
    assert inner(one, two) == pytest.approx(np.array([[2.0 * STRETCH]]))
