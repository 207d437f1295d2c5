"""Bodies of a machine where its channels say that they are."""

import mujoco
import numpy as np
import pytest

from ves_twin.machines.load import machine_of
from ves_twin.plant.layout import Layout
from ves_twin.plant.plant import Plant
from ves_twin.plant.statics import place_rig


def test_a_pendulum_hangs_where_its_encoder_says():
    drawing = machine_of("pendulum").drawing()
    assert drawing.needs == {"joint.angle": 1}
    angles = np.array([0.0, 0.3, -1.2])
    qpos = drawing.place({"joint.angle": angles[:, None]})
    data, joint = mujoco.MjData(drawing.model), drawing.model.joint("joint")
    for angle, row in zip(angles, qpos, strict=True):
        data.qpos[:] = row
        mujoco.mj_kinematics(drawing.model, data)
        assert data.qpos[joint.qposadr[0]] == pytest.approx(angle)


def test_ves2_stands_where_its_legs_and_encoders_say():
    """The lengths of a pose lead back to it, and the rig is drawn there."""
    machine = machine_of("ves2")
    drawing, plant = machine.drawing(), Plant.load("ves2")
    poses = np.array([[0.01, -0.02, 0.03, 0.02, -0.01, 0.03], [0.0, 0.0, -0.05, 0.0, 0.05, 0.0]])
    joints = np.array([[0.1, -0.4, 0.7], [1.0, 0.2, -0.3]])
    lengths = np.array([plant.geometry.lengths(pose) for pose in poses])
    qpos = drawing.place({"leg.length": lengths, "arm.q": joints})
    layout, data = Layout.of(drawing.model), mujoco.MjData(drawing.model)
    for row, pose, q in zip(qpos, poses, joints, strict=True):
        place_rig(data, layout, plant.geometry, pose, q)
        assert row == pytest.approx(data.qpos, abs=1e-7)


def test_lengths_that_no_pose_has_leave_ves2_where_it_stood():
    drawing = machine_of("ves2").drawing()
    good = Plant.load("ves2").geometry.lengths(np.zeros(6))
    lengths, joints = np.array([good, 0.05 * good]), np.zeros((2, 3))
    qpos = drawing.place({"leg.length": lengths, "arm.q": joints})
    assert qpos[1] == pytest.approx(qpos[0])


def test_a_machine_of_poses_at_rest_is_not_drawn_by_what_it_does_not_measure():
    assert machine_of("ft_wrist").drawing() is None
