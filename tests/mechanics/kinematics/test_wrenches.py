"""Laws of wrench transforms: rotation and moment arm, power, inversion, the sign of E-32."""

import numpy as np
from scipy.spatial.transform import Rotation

from ves_twin.mechanics.kinematics.wrenches import rotate_wrench, sensor_to_top, top_to_sensor

POSITION = np.array([-0.001, -0.00066, 0.18944])  # thesis eq. D.1
FLIP = np.diag([1.0, -1.0, -1.0])
ROUND_OFF = 1e-12
"""Sums of three products of at most 3000 N m."""

RNG = np.random.default_rng(4)
WRENCHES = RNG.normal(size=(50, 6)) * [300, 300, 900, 100, 100, 100]
POSITIONS = RNG.normal(size=(50, 3))
CASES = list(zip(WRENCHES, POSITIONS, strict=True)) + [(w, POSITION) for w in WRENCHES]


def direct(wrench, position):
    force, moment = FLIP @ wrench[:3], FLIP @ wrench[3:]
    return np.concatenate([force, moment + np.cross(position, force)])


def as_printed(wrench, position):
    """Equation D.1 of the thesis, last sign wrong (errata E-32)."""
    result = direct(wrench, position)
    result[5] = -wrench[5] - position[0] * wrench[1] + position[1] * wrench[0]
    return result


def test_sensor_to_top_is_a_half_turn_and_a_moment_arm():
    for wrench, position in CASES:
        np.testing.assert_allclose(
            sensor_to_top(wrench, position),
            direct(wrench, position),
            rtol=ROUND_OFF,
            atol=ROUND_OFF,
        )


def test_top_to_sensor_inverts_sensor_to_top():
    for wrench, position in CASES:
        there = sensor_to_top(wrench, position)
        np.testing.assert_allclose(
            top_to_sensor(there, position), wrench, rtol=ROUND_OFF, atol=ROUND_OFF
        )


def test_power_is_the_same_at_the_sensor_and_at_the_top():
    for wrench, position in CASES:
        velocity, spin = RNG.normal(size=(2, 3))
        at_sensor = np.concatenate([FLIP @ (velocity + np.cross(spin, position)), FLIP @ spin])
        at_top = np.concatenate([velocity, spin])
        np.testing.assert_allclose(
            sensor_to_top(wrench, position) @ at_top, wrench @ at_sensor, rtol=1e-10, atol=1e-9
        )


def test_the_printed_last_sign_would_cost_a_tenth_of_a_newton_metre_at_80_newton():
    """Errata E-32: 2 y0 Fx = 0.106 N m."""
    wrench = np.array([80.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    gap = as_printed(wrench, POSITION) - sensor_to_top(wrench, POSITION)
    np.testing.assert_allclose(gap, [0, 0, 0, 0, 0, 2 * POSITION[1] * 80.0], rtol=0, atol=ROUND_OFF)
    assert abs(abs(gap[5]) - 0.106) < 0.0005


def test_rotate_wrench_turns_force_and_moment_alike():
    for wrench in WRENCHES:
        r = Rotation.random(rng=RNG).as_matrix()
        expected = np.concatenate([r @ wrench[:3], r @ wrench[3:]])
        np.testing.assert_allclose(rotate_wrench(r, wrench), expected, rtol=0, atol=1e-11)
