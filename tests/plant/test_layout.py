"""The layout names the right places in MuJoCo's arrays."""

import mujoco
import numpy as np


def test_every_coordinate_is_named_exactly_once(rig):
    layout = rig.layout
    used = np.concatenate(
        [
            layout.slide_at,
            layout.universal_qpos,
            layout.bending_qpos,
            layout.platform_qpos + np.arange(7),
            layout.arm_qpos,
        ]
    )
    np.testing.assert_array_equal(np.sort(used), np.arange(rig.model.nq))


def test_a_slide_lengthens_its_own_leg(rig):
    model, layout = rig.model, rig.layout
    data = mujoco.MjData(model)
    for leg in range(6):
        data.qpos[:] = model.qpos0
        data.qpos[layout.slide_at[leg]] = 0.1
        mujoco.mj_kinematics(model, data)
        end, foot = data.site(f"leg{leg + 1}/rod_end").xpos, rig.plant.geometry.base[leg]
        home = rig.plant.geometry.lengths(np.zeros(6))[leg]
        assert abs(np.linalg.norm(end - foot) - home - 0.1) < 1e-12


def test_each_drive_pushes_its_own_joint(rig):
    model, layout = rig.model, rig.layout
    data = mujoco.MjData(model)
    for ctrl, dof in zip(
        [*layout.leg_ctrl, *layout.arm_ctrl], [*layout.speed_at, *layout.arm_dof], strict=True
    ):
        data.ctrl[:] = 0.0
        data.ctrl[ctrl] = 7.0
        mujoco.mj_forward(model, data)
        expected = np.zeros(model.nv)
        expected[dof] = 7.0
        np.testing.assert_array_equal(data.qfrc_actuator, expected)


def test_the_wrench_sensor_lists_force_before_torque(rig):
    model = rig.model
    assert model.sensor("force").adr[0] == rig.layout.wrench_sensor
    assert model.sensor("torque").adr[0] == rig.layout.wrench_sensor + 3
