"""Laws of the arm's kinematics: closed forms of the fact sheet, derivatives, inversion."""

import numpy as np
import pytest

from ves_twin.core.errors import UnreachableError
from ves_twin.mechanics.kinematics.puma560 import Puma560

D0, D1, D2, D3, A2, A3 = 0.22844, 0.672, -0.2435, 0.098, 0.4318, 0.4331  # thesis B.1
ROUND_OFF = 1e-12
"""Products of three transforms of lengths below 1 m."""
DIFFERENCE = 1e-7
"""Central difference with h = 1e-5: error h^2 times third derivatives of order one."""
INVERSION = 1e-10
"""m; the arccos of the elbow costs half the digits only within 1e-8 of a stretched arm."""
STEP = 1e-5

ARM = Puma560(d0=D0, d1=D1, d2=D2, d3=D3, a2=A2, a3=A3)
ANGLES = np.random.default_rng(3).uniform(-np.pi, np.pi, (200, 3))[::8]


def closed_form_origins(q):
    """Frame origins of fact sheet 4."""
    s1, c1, s2, c2 = np.sin(q[0]), np.cos(q[0]), np.sin(q[1]), np.cos(q[1])
    s23, c23 = np.sin(q[1] + q[2]), np.cos(q[1] + q[2])
    o1 = np.array([0.0, 0.0, D0 + D1])
    o2 = np.array([A2 * c1 * c2 + D2 * s1, A2 * s1 * c2 - D2 * c1, A2 * s2 + D0 + D1])
    o3 = o2 + np.array([A3 * c1 * c23 + D3 * s1, A3 * s1 * c23 - D3 * c1, A3 * s23])
    return np.array([o1, o2, o3])


def test_frame_origins_follow_the_closed_forms():
    for q in ANGLES:
        np.testing.assert_allclose(
            ARM.transforms(q)[:, :3, 3], closed_form_origins(q), rtol=0, atol=ROUND_OFF
        )


def test_frame_axes_follow_the_closed_forms():
    """All z are (s1, -c1, 0); x points along each link."""
    for q in ANGLES:
        frames, origins = ARM.transforms(q), closed_form_origins(q)
        z = [np.sin(q[0]), -np.cos(q[0]), 0.0]
        for frame in frames:
            np.testing.assert_allclose(frame[:3, 2], z, rtol=0, atol=ROUND_OFF)
            np.testing.assert_allclose(
                frame[:3, :3] @ frame[:3, :3].T, np.eye(3), rtol=0, atol=ROUND_OFF
            )
        for i, (length, d) in enumerate(((A2, D2), (A3, D3)), start=1):
            along = (origins[i] - origins[i - 1] - d * np.array(z)) / length
            np.testing.assert_allclose(frames[i, :3, 0], along, rtol=0, atol=ROUND_OFF)


def test_homogeneous_rows_end_in_zero_zero_zero_one():
    for q in ANGLES:
        np.testing.assert_array_equal(ARM.transforms(q)[:, 3], [[0.0, 0.0, 0.0, 1.0]] * 3)


def test_ready_position_points_straight_up():
    """Fact sheet 4: PUMA home is 180, 90, 0 deg."""
    tip = ARM.tip(np.radians([180.0, 90.0, 0.0]))
    np.testing.assert_allclose(tip, [0.0, D2 + D3, D0 + D1 + A2 + A3], rtol=0, atol=ROUND_OFF)


@pytest.mark.parametrize("link", [1, 2, 3])
def test_the_jacobian_is_the_derivative_of_a_point_on_a_link(link):
    for q in ANGLES:
        local = np.array([0.1, -0.2, 0.3, 1.0])
        point = (ARM.transforms(q)[link - 1] @ local)[:3]
        numeric = np.zeros((6, 3))
        for k, d in enumerate(STEP * np.eye(3)):
            rate = (ARM.transforms(q + d) - ARM.transforms(q - d))[link - 1] / (2 * STEP)
            spin = rate[:3, :3] @ ARM.transforms(q)[link - 1, :3, :3].T
            numeric[:3, k] = (rate @ local)[:3]
            numeric[3:, k] = spin[2, 1], spin[0, 2], spin[1, 0]
        np.testing.assert_allclose(ARM.jacobian(q, point, link), numeric, rtol=0, atol=DIFFERENCE)


def test_the_axes_are_lines_that_stay_where_they_are_when_the_joint_turns():
    for q in ANGLES:
        points, directions = ARM.axes(q)
        for i in range(3):
            moved = ARM.axes(q + 0.7 * np.eye(3)[i])
            np.testing.assert_allclose(moved[0][i], points[i], rtol=0, atol=ROUND_OFF)
            np.testing.assert_allclose(moved[1][i], directions[i], rtol=0, atol=ROUND_OFF)
            np.testing.assert_allclose(np.linalg.norm(directions[i]), 1.0, rtol=0, atol=ROUND_OFF)


@pytest.mark.parametrize("elbow", [-1, 1])
@pytest.mark.parametrize("shoulder", [-1, 1])
def test_every_branch_of_the_inverse_brings_the_tip_to_the_point(elbow, shoulder):
    for q in ANGLES:
        tip = ARM.tip(q)
        found = ARM.inverse(tip, elbow, shoulder)
        np.testing.assert_allclose(ARM.tip(found), tip, rtol=0, atol=INVERSION)
        assert np.sign(found[2]) == elbow
        forward = np.cos(found[0]) * tip[0] + np.sin(found[0]) * tip[1]
        assert np.sign(forward) == shoulder


def test_one_branch_of_the_inverse_is_the_configuration_that_made_the_point():
    for q in ANGLES:
        candidates = [
            ARM.inverse(ARM.tip(q), elbow, shoulder) for elbow in (-1, 1) for shoulder in (-1, 1)
        ]
        apart = [np.max(np.abs(np.exp(1j * c) - np.exp(1j * q))) for c in candidates]
        assert min(apart) < 1e-6  # arccos near a stretched arm: square root of round-off


@pytest.mark.parametrize(
    ("tip", "says"),
    [
        ((2.0, 0.0, 1.0), "reach is"),
        ((0.0, 0.0, 3.0), "nearer than the arm offset"),
        ((0.05, 0.05, 1.0), "nearer than the arm offset"),
        ((0.0, 0.5, -1.0), "reach is"),
    ],
)
def test_a_point_outside_the_workspace_is_refused_in_one_line(tip, says):
    with pytest.raises(UnreachableError, match=says) as caught:
        ARM.inverse(np.array(tip))
    assert "\n" not in str(caught.value)


def test_a_point_that_is_not_a_number_is_refused():
    with pytest.raises(UnreachableError):
        ARM.inverse(np.array([np.nan, 0.0, 1.0]))
