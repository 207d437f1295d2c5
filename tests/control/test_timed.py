"""Commands through rows of a file."""

import numpy as np

from ves_twin.control.arm_servo import spline
from ves_twin.control.timed import TimedJoints, TimedPoses

ROUND_OFF = 1e-12


def test_poses_are_straight_between_rows_and_stand_beyond_them():
    times = np.array([0.0, 0.5, 1.0])
    timed = TimedPoses(times, np.outer([0.0, 1.0, 4.0], np.ones(6)))
    for time, value in ((-1.0, 0.0), (0.0, 0.0), (0.25, 0.5), (0.5, 1.0), (0.75, 2.5), (9.0, 4.0)):
        np.testing.assert_allclose(timed.pose(time), value, atol=ROUND_OFF)


def test_the_spline_of_the_joints_passes_through_the_commands_of_the_file():
    times = 0.0126 * np.arange(50)
    commands = np.cumsum(np.random.default_rng(0).normal(size=(50, 3)), axis=0)
    joints = TimedJoints.through(times, commands)
    q, rate = np.empty(3), np.empty(3)
    for k in range(1, 47):
        points = np.array([joints.q(times[k] + j * 0.0126) for j in (-1, 0, 1, 2)])
        spline(points, 0.0, 0.0126, q, rate)
        np.testing.assert_allclose(q, commands[k], rtol=0, atol=1e-10)
