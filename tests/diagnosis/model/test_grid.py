"""The analysis grid: noise through a low-pass as its rows see it."""

import numpy as np
import pytest
from scipy.signal import butter, lfilter

from ves_twin.diagnosis.model.grid import AnalysisGrid

TICK = 1.0 / 2933.0


@pytest.mark.parametrize(("every", "factor"), [(37, 1), (5, 6)])
def test_the_autocovariance_of_filtered_noise_is_that_of_a_simulated_one(every, factor):
    numerator, denominator = butter(2, 20.0, fs=1.0 / TICK)
    white = np.random.default_rng(0).standard_normal(2_000_000)
    noise = lfilter(numerator, denominator, white)
    grid = AnalysisGrid(every * TICK, factor)
    rows = grid.reduce((noise / noise.std())[::every, None])[:, 0].astype(float)
    found = [np.mean(rows[: len(rows) - k] * rows[k:]) for k in range(5)]
    # about 40000 independent values: the sd of a product's mean is 0.005
    assert found == pytest.approx(grid.autocovariance(1.0, 4, 20.0), abs=0.025)


def test_white_noise_stays_white_where_no_row_is_left_out():
    assert AnalysisGrid(0.01, 1).autocovariance(2.0, 3) == pytest.approx([4.0, 0.0, 0.0, 0.0])
