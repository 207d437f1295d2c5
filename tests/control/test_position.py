"""Position mode follows its motion, whatever is measured."""

import dataclasses

import numpy as np

from ves_twin.control.position import PositionController


def test_the_command_is_the_motion(task, readings):
    controller = PositionController.build(task)
    pushed = readings(wrench_in_sensor=np.full(6, 500.0))
    for t in (0.0, 0.3, 1.7, 12.0):
        np.testing.assert_array_equal(controller.update(t, pushed), task.motion.pose(t))


def test_without_a_motion_the_platform_stays_where_it_starts(task, readings):
    controller = PositionController.build(dataclasses.replace(task, motion=None))
    for t in (0.0, 5.0):
        np.testing.assert_array_equal(controller.update(t, readings()), task.start)
