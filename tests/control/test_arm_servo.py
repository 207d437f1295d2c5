"""The joint servo: a smooth spline through the commands, and a limited torque."""

import numpy as np
import pytest
from scipy.interpolate import BSpline

from ves_twin.control import arm_servo

CYCLE = 1.0 / 80.0
ROUND_OFF = 1e-13
"""Weights that sum to one on angles of a few radians; rates are those over 1/80 s."""
RNG = np.random.default_rng(16)
COMMANDS = RNG.normal(size=(12, 3))


def blend(points, u):
    q, rate = np.empty(3), np.empty(3)
    arm_servo.spline(np.ascontiguousarray(points, dtype=float), u, CYCLE, q, rate)
    return q, rate


@pytest.mark.parametrize("k", range(1, 8))
def test_at_a_command_the_path_is_the_smoothed_command(k):
    points = COMMANDS[k - 1 : k + 3]
    q, _ = blend(points, 0.0)
    np.testing.assert_allclose(
        q, (points[0] + 4 * points[1] + points[2]) / 6, rtol=0, atol=ROUND_OFF
    )
    q, _ = blend(points, 1.0)
    np.testing.assert_allclose(
        q, (points[1] + 4 * points[2] + points[3]) / 6, rtol=0, atol=ROUND_OFF
    )


@pytest.mark.parametrize("k", range(7))
def test_angle_and_rate_are_continuous_from_cycle_to_cycle(k):
    end, end_rate = blend(COMMANDS[k : k + 4], 1.0)
    begin, begin_rate = blend(COMMANDS[k + 1 : k + 5], 0.0)
    np.testing.assert_allclose(end, begin, rtol=0, atol=ROUND_OFF)
    np.testing.assert_allclose(end_rate, begin_rate, rtol=0, atol=ROUND_OFF / CYCLE)


def test_the_path_is_the_uniform_cubic_b_spline_of_scipy():
    reference = BSpline(np.arange(-3.0, 5.0), COMMANDS[:4], 3)
    for u in np.linspace(0.0, 1.0, 21, endpoint=False):
        q, rate = blend(COMMANDS[:4], u)
        np.testing.assert_allclose(q, reference(u), rtol=0, atol=ROUND_OFF)
        np.testing.assert_allclose(rate, reference(u, 1) / CYCLE, rtol=0, atol=ROUND_OFF / CYCLE)


def test_a_straight_line_is_reproduced():
    """Commands k-1, k, k+1, k+2 on a line: at u the path is on it, at its slope."""
    start, slope = np.array([0.3, -1.0, 2.0]), np.array([1.0, -2.0, 0.5])
    points = start + slope * CYCLE * np.array([[-1.0], [0.0], [1.0], [2.0]])
    for u in np.linspace(0.0, 1.0, 11):
        q, rate = blend(points, u)
        np.testing.assert_allclose(q, start + slope * CYCLE * u, rtol=0, atol=ROUND_OFF)
        np.testing.assert_allclose(rate, slope, rtol=0, atol=ROUND_OFF / CYCLE)


def torque(integral=0.0, q_set=0.0, rate_set=0.0, q=0.0, rate=0.0, limit=100.0):
    p = np.zeros(1, arm_servo.PARAMETERS)
    p["stiffness"], p["damping"], p["limit"] = [7.0, 8.0, 9.0], [0.7, 0.8, 0.9], limit
    result = np.empty(3)
    arm_servo.servo_torque(
        p[0], *(np.full(3, float(v)) for v in (integral, q_set, rate_set, q, rate)), result
    )
    return result


def test_the_torque_is_stiffness_damping_and_integral():
    found = torque(integral=0.5, q_set=1.0, rate_set=2.0, q=0.4, rate=-1.0)
    expected = np.array([7.0, 8.0, 9.0]) * 0.6 + np.array([0.7, 0.8, 0.9]) * 3.0 + 0.5
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-14)


def test_on_its_set_point_the_joint_gets_the_integral_alone():
    np.testing.assert_array_equal(torque(integral=3.0, q_set=1.0, rate_set=2.0, q=1.0, rate=2.0), 3)


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_the_drives_limit_the_torque(sign):
    np.testing.assert_array_equal(torque(q_set=sign * 1000.0, limit=50.0), sign * 50.0)
    np.testing.assert_array_equal(torque(integral=sign * 1000.0, limit=50.0), sign * 50.0)
