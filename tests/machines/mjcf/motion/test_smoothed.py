"""A motion that a log cuts off keeps its speed and acceleration at its ends."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import butter, filtfilt

from ves_twin.machines.mjcf.motion.smoothed import smoothed

PERIOD = 0.002
TIME = PERIOD * np.arange(5000)


def pull(column: np.ndarray) -> np.ndarray:
    return np.gradient(np.gradient(column, PERIOD), PERIOD)


def off(found: np.ndarray, true: np.ndarray, corner: float) -> float:
    """Rms of the first and last period of a corner, as a share of all of it."""
    count = round(1.0 / (corner * PERIOD))
    ends = np.r_[found[:count] - true[:count], found[-count:] - true[-count:]]
    return float(np.sqrt(np.mean(ends**2)) / np.std(true))


@pytest.mark.parametrize("corner", [5.0, 10.0])
def test_a_swing_that_is_cut_off_keeps_its_acceleration(corner):
    """x = 3 t + sin (2 t + 1): a tenth, by the parabola's third derivative; turned about its end 2.

    The ramp alone, which a wheel or a carriage has, would begin with 25 times its acceleration.
    """
    motion = 3.0 * TIME + np.sin(2.0 * TIME + 1.0)
    true = -4.0 * np.sin(2.0 * TIME + 1.0)
    assert off(pull(smoothed(motion, PERIOD, corner)), true, corner) < 0.12
    b, a = butter(4, 2.0 * corner * PERIOD)
    assert off(pull(filtfilt(b, a, motion)), true, corner) > 2.0


def test_a_parabola_passes_as_it_is():
    """To what is left of the filter's own start, two periods beyond, where it is steep."""
    motion = 1.0 - 2.0 * TIME + 3.0 * TIME**2
    assert pull(smoothed(motion, PERIOD, 8.0))[2:-2] == pytest.approx(6.0, rel=0.03)


def test_white_noise_is_not_louder_at_the_ends_by_more_than_a_third():
    count, values = round(1.0 / (10.0 * PERIOD)), []
    for seed in range(100):
        rows = np.random.default_rng(seed).standard_normal(1000)
        found = smoothed(rows, PERIOD, 10.0)
        values.append([np.mean(np.r_[found[:count], found[-count:]] ** 2), np.mean(found**2)])
    ends, whole = np.sqrt(np.mean(values, axis=0))
    assert ends < 1.33 * whole


@pytest.mark.parametrize("rows", [1, 2, 3, 10])
def test_a_few_rows_are_smoothed(rows):
    line = np.arange(float(rows))
    assert smoothed(line, PERIOD, 5.0) == pytest.approx(line, abs=0.002)
