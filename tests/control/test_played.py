"""Playing back set-points."""

import numpy as np

from ves_twin.control.arm_servo import spline
from ves_twin.control.played import PlayedPoses, spline_points

ROUND_OFF = 1e-13


def test_the_spline_of_the_points_passes_through_the_commands():
    commands = np.cumsum(np.random.default_rng(0).normal(size=(40, 3)), axis=0)
    points = spline_points(commands)
    q, rate = np.empty(3), np.empty(3)
    for k in range(1, 37):
        spline(points[k - 1 : k + 3].copy(), 0.0, 0.01, q, rate)
        np.testing.assert_allclose(q, commands[k], rtol=0, atol=ROUND_OFF * 40)


def test_a_pose_is_held_before_the_first_and_after_the_last_cycle():
    played = PlayedPoses(np.arange(18.0).reshape(3, 6), 0.01)
    assert played.pose(-1.0)[0] == 0.0
    assert played.pose(0.0101)[0] == 6.0
    assert played.pose(9.0)[0] == 12.0
