"""The emulation error is a matter of arithmetic, whatever the parts it is summed from."""

import numpy as np
import pytest

from ves_twin.simulator.emulation_error import emulation_error


@pytest.fixture
def rows():
    rng = np.random.default_rng(4)
    return tuple(rng.normal(size=(100, 6)) for _ in range(3))


def test_error_is_truth_less_reference(rows):
    truth, ideal, lag = rows
    found = emulation_error([rows])["y"]
    error = truth[:, 1] - ideal[:, 1]
    assert found.rms == pytest.approx(np.sqrt(np.mean(error**2)))
    assert found.peak == pytest.approx(np.max(np.abs(error)))
    assert found.rms_leg_lag == pytest.approx(np.sqrt(np.mean((lag - ideal)[:, 1] ** 2)))
    assert found.rms_rest == pytest.approx(np.sqrt(np.mean((truth - lag)[:, 1] ** 2)))
    size = np.max(np.linalg.norm(ideal[:, :3], axis=1))
    assert found.relative == pytest.approx(found.peak / size)


def test_rotations_are_relative_to_rotations(rows):
    found = emulation_error([rows])["rx"]
    assert found.relative == pytest.approx(
        found.peak / np.max(np.linalg.norm(rows[1][:, 3:], axis=1))
    )


def test_parts_give_the_same_as_the_whole(rows):
    parts = [tuple(values[k : k + 30] for values in rows) for k in range(0, 100, 30)]
    whole, pieces = emulation_error([rows]), emulation_error(parts)
    for axis, error in whole.items():
        assert pieces[axis].rms == pytest.approx(error.rms, rel=1e-14)
        assert pieces[axis].relative == pytest.approx(error.relative, rel=1e-14)


def test_reference_that_stands_still_has_no_relative_error(rows):
    still = (rows[0], np.zeros((100, 6)), np.zeros((100, 6)))
    assert emulation_error([still])["z"].relative is None


def test_nothing_or_a_reference_that_diverged_gives_no_figure(rows):
    assert emulation_error([]) == {}
    assert emulation_error([(rows[0], rows[1] * np.nan, rows[2])]) == {}
