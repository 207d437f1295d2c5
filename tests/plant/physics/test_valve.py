"""The spool's lag is exact at any step."""

import numpy as np
import pytest
from scipy.integrate import quad

from ves_twin.plant.physics import valve

ROUND_OFF = 1e-14
"""One exponential and a few products of numbers of size one."""
CANCELLATION = 1e-10
"""1 - exp(-h / lag) over h / lag loses h / lag = 1e-5 of the digits at the smallest step."""
LAG = 0.004
CURRENT = np.array([1.0, -1.0, 0.3, 0.0, -0.2, 0.7])
SPOOL = np.array([0.0, 0.5, -0.4, 0.9, -0.2, -1.0])


def moved(step, times=1, lag=LAG):
    p, s = np.zeros(1, valve.PARAMETERS), np.zeros(1, valve.STATE)
    p["lag"], s["spool"] = lag, SPOOL
    means = []
    for _ in range(times):
        valve.move_spool(p[0], s[0], CURRENT, step)
        means.append(s["mean"][0].copy())
    return s["spool"][0], np.array(means)


@pytest.mark.parametrize("step", [4e-8, 341e-6, 1e-3, 0.004, 0.1])
def test_the_spool_follows_the_exact_step_response(step):
    expected = CURRENT + (SPOOL - CURRENT) * np.exp(-step / LAG)
    np.testing.assert_allclose(moved(step)[0], expected, rtol=0, atol=ROUND_OFF)


@pytest.mark.parametrize("step", [4e-8, 341e-6, 1e-3, 0.004, 0.1])
def test_the_mean_is_the_integral_over_the_step(step):
    means = moved(step)[1][0]
    for i in range(6):
        gap = SPOOL[i] - CURRENT[i]
        area, _ = quad(lambda t, i=i, gap=gap: CURRENT[i] + gap * np.exp(-t / LAG), 0.0, step)
        assert abs(means[i] - area / step) < CANCELLATION


def test_ten_small_steps_are_one_large_step():
    spool, means = moved(1e-4, times=10)
    whole, mean = moved(1e-3)
    np.testing.assert_allclose(spool, whole, rtol=0, atol=ROUND_OFF)
    np.testing.assert_allclose(means.mean(axis=0), mean[0], rtol=0, atol=1e-13)


def test_a_spool_at_its_command_stays():
    p, s = np.zeros(1, valve.PARAMETERS), np.zeros(1, valve.STATE)
    p["lag"], s["spool"] = LAG, CURRENT
    valve.move_spool(p[0], s[0], CURRENT, 341e-6)
    np.testing.assert_array_equal(s["spool"][0], CURRENT)
    np.testing.assert_array_equal(s["mean"][0], CURRENT)
