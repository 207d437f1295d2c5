"""The spool's lag is exact at any step; null, deadband, gain and limit as their closed forms."""

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


def blocks(lag=LAG, **changes):
    p, s = np.zeros(1, valve.PARAMETERS), np.zeros(1, valve.STATE)
    p["lag"], p["gain"], p["limit"], s["spool"] = lag, 1.0, 1.0, SPOOL
    for name, value in changes.items():
        p[name] = value
    return p, s


def moved(step, times=1, lag=LAG):
    p, s = blocks(lag)
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
    p, s = blocks()
    s["spool"] = CURRENT
    valve.move_spool(p[0], s[0], CURRENT, 341e-6)
    np.testing.assert_array_equal(s["spool"][0], CURRENT)
    np.testing.assert_array_equal(s["mean"][0], CURRENT)


def test_each_leg_has_its_own_lag():
    lags = LAG * np.array([0.5, 1.0, 1.5, 2.0, 3.0, 4.0])
    expected = CURRENT + (SPOOL - CURRENT) * np.exp(-1e-3 / lags)
    np.testing.assert_allclose(moved(1e-3, lag=lags)[0], expected, rtol=0, atol=ROUND_OFF)


def opening(spool, **changes):
    """Openings (6,) of spools that rest at these travels."""
    p, s = blocks(**changes)
    s["spool"] = spool
    valve.move_spool(p[0], s[0], np.asarray(spool, float), 341e-6)
    return s["mean"][0]


def test_a_valve_without_faults_opens_as_its_spool_stands():
    np.testing.assert_array_equal(opening(CURRENT), CURRENT)


def test_null_shifts_the_opening_of_its_own_leg():
    null = np.array([0.02, -0.02, 0.0, 0.3, 0.0, 0.0])
    np.testing.assert_allclose(opening(CURRENT, null=null), CURRENT + null, rtol=0, atol=ROUND_OFF)


def test_deadband_takes_its_width_from_both_sides_of_the_null():
    travel = np.array([0.1, -0.1, 0.03, -0.03, 0.5, 0.0])
    found = opening(travel, deadband=0.05, null=0.01)
    np.testing.assert_allclose(found, [0.06, -0.04, 0, 0, 0.46, 0], rtol=0, atol=ROUND_OFF)


def test_gain_scales_the_opening_after_the_deadband():
    found = opening(np.full(6, 0.2), deadband=0.05, gain=[1.0, 0.8, 1.2, 0.0, 1.0, 1.0])
    np.testing.assert_allclose(found, 0.15 * np.array([1, 0.8, 1.2, 0, 1, 1]), atol=ROUND_OFF)


def test_a_spool_at_its_stop_goes_no_further_and_leaves_it_at_once():
    p, s = blocks(limit=0.4)
    s["spool"] = 0.0
    for _ in range(1000):
        valve.move_spool(p[0], s[0], np.ones(6), 341e-6)
    np.testing.assert_allclose(s["spool"][0], 0.4, rtol=1e-12)
    valve.move_spool(p[0], s[0], -np.ones(6), 341e-6)
    assert np.all(s["spool"][0] < 0.4 - 0.06)  # 0.8 (1 - exp(-341 us / 4 ms)) = 0.065


def test_the_flow_through_a_deadband_converges_in_the_step():
    """Spools that swing across both edges; the exact integral by adaptive quadrature."""
    dead, total = 0.1, 0.032

    def exact(i):
        def rate(t):
            x = CURRENT[i] + (SPOOL[i] - CURRENT[i]) * np.exp(-t / LAG)
            return np.sign(x) * max(abs(x) - dead, 0.0)

        gap = SPOOL[i] - CURRENT[i]
        edges = [(e - CURRENT[i]) / gap for e in (-dead, dead)] if gap else []
        corners = [-LAG * np.log(r) for r in edges if 0.0 < r < 1.0]
        return quad(rate, 0.0, total, points=corners or None, epsabs=1e-13)[0]

    errors = []
    for count in (94, 188, 376, 752):
        p, s = blocks(deadband=dead)
        flow = np.zeros(6)
        for _ in range(count):
            valve.move_spool(p[0], s[0], CURRENT, total / count)
            flow += s["mean"][0] * total / count
        errors.append(np.max(np.abs(flow - [exact(i) for i in range(6)])))
    assert errors[0] < 1e-4 * total  # share of full opening, at the tick of 341 us
    # second order on average: the edge falls anywhere within a step
    assert errors[-1] < errors[0] / 16.0
