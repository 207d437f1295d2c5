"""Laws of the platform's kinematics: inversion, derivatives, workspace of ves2."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from ves_twin.core.errors import UnreachableError
from ves_twin.mechanics.kinematics.stewart import StewartGeometry, pose_jacobian, track_poses
from ves_twin.plant.plant import Plant

INVERSION = 1e-10
"""m and rad. Newton ends at leg errors of 1e-12 m; the Jacobian's condition is below 100."""
DIFFERENCE = 1e-7
"""Central difference with h = 1e-5: error h^2 times third derivatives of order one."""
STEP = 1e-5
TABLE_5_2 = np.array([0.2, -0.2, 0.1, *np.radians([10.0, -10.0, 20.0])])
HEAVE = np.array([0.0, 0.0, -0.15, 0.0, 0.0, 0.0])


@pytest.fixture(scope="module")
def plant() -> Plant:
    return Plant.load("ves2")


@pytest.fixture(scope="module")
def geometry(plant) -> StewartGeometry:
    return plant.geometry


@pytest.fixture(scope="module")
def travel(plant) -> float:
    number = plant.parameters.number
    return number("leg.stroke") / 2 - number("leg.margin")


@pytest.fixture(scope="module")
def poses(geometry, travel) -> np.ndarray:
    """200 random poses that every leg reaches."""
    rng = np.random.default_rng(1)
    home, found = geometry.lengths(np.zeros(6)), []
    while len(found) < 200:
        pose = rng.uniform(-1, 1, 6) * [0.25, 0.25, 0.25, 0.35, 0.35, 0.5]
        if np.max(np.abs(geometry.lengths(pose) - home)) <= travel:
            found.append(pose)
    return np.array(found)


def direct_lengths(geometry, position, rotation):
    tops = geometry.home + position + geometry.top @ rotation.T
    return np.linalg.norm(tops - geometry.base, axis=1)


def test_forward_kinematics_inverts_inverse_kinematics(geometry, poses, figure):
    worst = 0.0
    for pose in poses:
        worst = max(worst, np.max(np.abs(geometry.pose(geometry.lengths(pose)) - pose)))
    figure("platform: forward after inverse kinematics", worst, INVERSION, "m or rad")


def test_lengths_are_distances_between_joints(geometry, poses):
    for pose in poses:
        rotation = Rotation.from_euler("xyz", pose[3:]).as_matrix()
        np.testing.assert_allclose(
            geometry.lengths(pose), direct_lengths(geometry, pose[:3], rotation), rtol=0, atol=1e-14
        )


def test_the_jacobian_is_the_derivative_of_the_lengths_by_the_twist(geometry, poses):
    for pose in poses[:50]:
        rotation = Rotation.from_euler("xyz", pose[3:])
        numeric = np.empty((6, 6))
        for k, axis in enumerate(np.vstack([np.eye(3), np.eye(3)]) * STEP):
            moved = []
            for sign in (1, -1):
                shift = sign * axis if k < 3 else np.zeros(3)
                turn = Rotation.from_rotvec(sign * axis if k >= 3 else np.zeros(3)) * rotation
                moved.append(direct_lengths(geometry, pose[:3] + shift, turn.as_matrix()))
            numeric[:, k] = (moved[0] - moved[1]) / (2 * STEP)
        np.testing.assert_allclose(geometry.jacobian(pose), numeric, rtol=0, atol=DIFFERENCE)


def test_the_pose_jacobian_is_the_derivative_of_the_lengths_by_the_pose(geometry, poses):
    for pose in poses[:50]:
        numeric = np.column_stack(
            [
                (geometry.lengths(pose + d) - geometry.lengths(pose - d)) / (2 * STEP)
                for d in STEP * np.eye(6)
            ]
        )
        jacobian = pose_jacobian(pose, geometry.base, geometry.top, geometry.home)
        np.testing.assert_allclose(jacobian, numeric, rtol=0, atol=DIFFERENCE)


def test_tracking_a_slow_series_equals_solving_each_pose(geometry):
    time = np.linspace(0.0, 3.0, 300)
    amplitude = [0.08, 0.08, 0.06, 0.1, 0.1, 0.15]
    series = np.column_stack([a * np.sin((k + 1) * time) for k, a in enumerate(amplitude)])
    assert_tracked(geometry, series)


def test_tracking_survives_jumps_across_the_workspace(geometry, poses):
    assert_tracked(geometry, poses)


def track(geometry, pieces, start):
    g, pose = geometry, start.copy()
    inverse = np.linalg.inv(pose_jacobian(pose, g.base, g.top, g.home))
    return np.vstack([track_poses(rows, pose, inverse, g.base, g.top, g.home) for rows in pieces])


def test_a_series_in_pieces_gives_the_same_bits_as_a_whole(geometry, poses):
    lengths = np.array([geometry.lengths(pose) for pose in poses])
    whole = track(geometry, [lengths], poses[0])
    pieces = track(geometry, [lengths[:7], lengths[7:8], lengths[8:]], poses[0])
    np.testing.assert_array_equal(whole, pieces)


def assert_tracked(geometry, series):
    lengths = np.array([geometry.lengths(pose) for pose in series])
    tracked = track(geometry, [lengths], series[0])
    np.testing.assert_allclose(tracked, series, rtol=0, atol=INVERSION)
    np.testing.assert_allclose(
        tracked,
        [geometry.pose(row, guess) for row, guess in zip(lengths, series, strict=True)],
        rtol=0,
        atol=INVERSION,
    )


@pytest.mark.parametrize("pose", [TABLE_5_2, HEAVE], ids=["start of Table 5-2", "heave -0.15 m"])
def test_ves2_reaches_the_poses_that_the_thesis_names(geometry, travel, pose, figure):
    change = geometry.lengths(pose) - geometry.lengths(np.zeros(6))
    figure(
        "leg travel of a named pose (Table 5-2 start; heave -0.15 m)",
        np.max(np.abs(change)),
        travel,
        "m",
    )


def test_the_start_of_table_5_2_leaves_12_mm_of_stroke(geometry, plant):
    """models/ves2.toml says so beside stroke and margin; half a millimetre is its last digit."""
    change = geometry.lengths(TABLE_5_2) - geometry.lengths(np.zeros(6))
    left = plant.parameters.number("leg.stroke") / 2 - np.max(np.abs(change))
    assert abs(left - 0.012) < 0.0005


def test_at_home_all_legs_are_as_long_as_the_law_of_cosines_says(geometry):
    """Circles of 0.7 and 0.5 m, joints 60 - 10 - 10 = 40 deg apart, planes 0.95 m apart."""
    expected = np.sqrt(0.95**2 + 0.7**2 + 0.5**2 - 2 * 0.7 * 0.5 * np.cos(np.radians(40.0)))
    np.testing.assert_allclose(geometry.lengths(np.zeros(6)), expected, rtol=0, atol=1e-14)


def test_the_geometry_repeats_every_120_degrees(geometry):
    third = Rotation.from_euler("z", 120, degrees=True).as_matrix()
    for joints in (geometry.base, geometry.top):
        np.testing.assert_allclose(
            np.roll(joints, -2, axis=0), joints @ third.T, rtol=0, atol=1e-14
        )


def test_the_platform_frame_lies_its_offset_above_the_joint_plane(geometry):
    np.testing.assert_allclose(geometry.top[:, 2], -0.05, rtol=0, atol=1e-15)
    np.testing.assert_allclose(geometry.home, [0.0, 0.0, 1.0], rtol=0, atol=1e-15)


@pytest.mark.parametrize(
    "lengths",
    [np.zeros(6), -np.ones(6), np.full(6, np.nan), np.full(6, np.inf), np.full(6, 0.3)],
    ids=["zero", "negative", "nan", "inf", "shorter than the circles allow"],
)
def test_lengths_that_no_pose_has_are_refused_in_one_line(geometry, lengths):
    with pytest.raises(UnreachableError) as caught:
        geometry.pose(lengths)
    assert "\n" not in str(caught.value)


def test_lengths_at_random_are_solved_or_refused_but_never_crash(geometry):
    rng = np.random.default_rng(2)
    refused = 0
    for _ in range(300):
        lengths = rng.uniform(-0.5, 4.0, 6)
        try:
            pose = geometry.pose(lengths)
        except UnreachableError:
            refused += 1
        else:
            np.testing.assert_allclose(geometry.lengths(pose), lengths, rtol=0, atol=INVERSION)
    assert refused > 200
