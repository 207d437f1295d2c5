"""Laws of rotations: orthonormality, round trips, agreement with scipy, the rate matrix."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from ves_twin.mechanics.kinematics.rotations import (
    angles_from_matrix,
    matrix_from_angles,
    matrix_from_quaternion,
    quaternion_from_angles,
    rate_matrix,
)

ROUND_OFF = 1e-14
"""A few products of numbers of size one in double precision."""
NEAR_GIMBAL_LOCK = 1e-11
"""At |phiY| = 1.5 rad the angles lose a factor 1 / cos(1.5)^2 = 200 of the round-off."""
DIFFERENCE = 1e-8
"""Central difference with h = 1e-5: error h^2 = 1e-10 times third derivatives, round-off 1e-11."""
STEP = 1e-5

settings.register_profile("fixed", deadline=None, derandomize=True, max_examples=200)
fixed = settings.get_profile("fixed")

turn = st.floats(-3.1, 3.1)
pitch = st.floats(-1.5, 1.5)
attitudes = st.tuples(turn, pitch, turn).map(np.array)


@fixed
@given(attitudes)
def test_the_matrix_is_orthonormal_and_right_handed(angles):
    r = matrix_from_angles(angles)
    np.testing.assert_allclose(r @ r.T, np.eye(3), rtol=0, atol=ROUND_OFF)
    assert np.linalg.det(r) > 0.5


@fixed
@given(attitudes)
def test_the_matrix_equals_scipy_with_fixed_axes_x_y_z(angles):
    expected = Rotation.from_euler("xyz", angles).as_matrix()
    np.testing.assert_allclose(matrix_from_angles(angles), expected, rtol=0, atol=ROUND_OFF)


@fixed
@given(attitudes)
def test_angles_come_back_from_the_matrix(angles):
    np.testing.assert_allclose(
        angles_from_matrix(matrix_from_angles(angles)), angles, rtol=0, atol=NEAR_GIMBAL_LOCK
    )


@fixed
@given(attitudes)
def test_the_quaternion_is_a_unit_quaternion_of_the_same_rotation(angles):
    q = quaternion_from_angles(angles)
    assert abs(np.linalg.norm(q) - 1.0) < ROUND_OFF
    np.testing.assert_allclose(
        matrix_from_quaternion(q), matrix_from_angles(angles), rtol=0, atol=1e-14
    )


@fixed
@given(attitudes)
def test_the_quaternion_has_its_scalar_part_first(angles):
    expected = Rotation.from_euler("xyz", angles).as_quat(scalar_first=True)
    q = quaternion_from_angles(angles)
    sign = np.sign(q @ expected)  # q and -q are the same rotation
    np.testing.assert_allclose(sign * q, expected, rtol=0, atol=ROUND_OFF)


@fixed
@given(attitudes, st.tuples(*[st.floats(-1, 1)] * 3).map(np.array))
def test_the_rate_matrix_gives_the_angular_velocity_of_the_matrix(angles, rates):
    ahead = matrix_from_angles(angles + STEP * rates)
    behind = matrix_from_angles(angles - STEP * rates)
    spin = (ahead - behind) / (2 * STEP) @ matrix_from_angles(angles).T
    x, y, z = rate_matrix(angles) @ rates
    skew = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]]
    np.testing.assert_allclose(spin, skew, rtol=0, atol=DIFFERENCE)


def test_at_home_angular_velocity_is_the_rate_of_the_angles():
    np.testing.assert_array_equal(rate_matrix(np.zeros(3)), np.eye(3))


@fixed
@given(attitudes)
def test_gravity_in_the_platform_frame_is_equation_3_4(angles):
    """Errata E-1: g_t = g (sin phiY, -sin phiX cos phiY, -cos phiX cos phiY)."""
    x, y, _ = angles
    expected = [np.sin(y), -np.sin(x) * np.cos(y), -np.cos(x) * np.cos(y)]
    down = matrix_from_angles(angles).T @ np.array([0.0, 0.0, -1.0])
    np.testing.assert_allclose(down, expected, rtol=0, atol=ROUND_OFF)
