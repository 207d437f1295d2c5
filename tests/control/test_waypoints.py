"""Way points: where the platform is between, at and after them."""

import numpy as np

from ves_twin.control.waypoints import Waypoint, Waypoints

ONE, TWO = np.arange(6.0), -np.arange(6.0)
MOTION = Waypoints(np.zeros(6), (Waypoint(1.0, 2.0, ONE), Waypoint(4.0, 1.0, TWO)))


def test_it_stands_before_between_and_after_the_moves():
    for time, pose in ((0.0, np.zeros(6)), (3.5, ONE), (9.0, TWO)):
        np.testing.assert_allclose(MOTION.pose(time), pose, rtol=0, atol=1e-15)


def test_half_way_in_time_is_half_way():
    np.testing.assert_allclose(MOTION.pose(2.0), ONE / 2, rtol=0, atol=1e-15)
