"""A free joint that is fed in moves: its rates are those of MuJoCo's own motion."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from ves_twin.core.errors import InvalidInputError
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.rig.machine import Rig

BOX = """
<mujoco model="box">
  <option timestep="0.001" integrator="RK4" gravity="0 0 0"><flag contact="disable"/></option>
  <worldbody>
    <body name="box">
      {joint}
      <inertial pos="0 0 0" mass="3" diaginertia="0.02 0.03 0.04"/>
      <site name="imu" pos="0.1 0 0.05"/>
    </body>
  </worldbody>
  <sensor><gyro name="gyro" site="imu"/><accelerometer name="acc" site="imu"/></sensor>
</mujoco>
"""

FILE = """
schema = 1
kind = "rig"
name = "box"
model = "box.xml"
clock = { column = "t" }
drive = { mode = "motion", joints = { base = "pose" }, smoothing = 15 }
effects = [{ kind = "sensor_gain", on = ["gyro.1"] }]
[signals]
pose = { columns = ["x", "y", "z", "qx", "qy", "qz", "qw"], unit = "1" }
gyro = { columns = ["a", "b", "c"], unit = "rad/s", sensor = "gyro", noise = 0.001 }
acc = { columns = ["d", "e", "f"], unit = "m/s^2", sensor = "acc", noise = 0.01 }
[typical.signal]
gyro = { span = 2 }
acc = { span = 2 }
"""

PERIOD = 0.005


def rig_of(folder, joint='<freejoint name="base"/>'):
    (folder / "box.xml").write_text(BOX.format(joint=joint))
    (folder / "box.toml").write_text(FILE)
    return Rig.load(str(folder / "box.toml"))


def test_a_tumbling_body_shows_the_rates_and_accelerations_that_it_has(tmp_path):
    model = mujoco.MjModel.from_xml_string(BOX.format(joint='<freejoint name="base"/>'))
    data, poses, sensed = mujoco.MjData(model), [], []
    data.qvel[:] = [0.2, -0.1, 0.3, 2.0, 0.1, 1.0]  # about no main axis, so that it nutates
    for k in range(800):
        mujoco.mj_forward(model, data)
        turn = data.qpos[[4, 5, 6, 3]] * (-1.0 if k % 3 == 0 else 1.0)  # both signs are one turn
        poses.append([*data.qpos[:3], *turn])
        sensed.append(data.sensordata.copy())
        mujoco.mj_step(model, data, 5)
    time = PERIOD * np.arange(800)
    forward = MjcfForward.of(rig_of(tmp_path))
    rows = forward.simulate(Excitation("tumble", time, {"pose": np.array(poses)}), {})
    inner = slice(40, -40)  # a low-pass of 15 Hz begins and ends beside the motion
    error = (rows - np.array(sensed))[inner]
    assert np.std(np.array(sensed)[inner, 0]) > 0.1
    assert np.max(np.abs(error[:, :3])) < 0.005  # rad/s of 2: differences of second order
    assert np.max(np.abs(error[:, 3:])) < 0.02  # m/s^2 of 0.7


def test_one_number_of_a_sensor_is_compared_by_itself(tmp_path):
    """An accelerometer of one axis, which MuJoCo has three of."""
    whole = rig_of(tmp_path)
    text = FILE.replace('["d", "e", "f"]', '["f"]').replace(
        '"acc", noise', '"acc", axis = "z", noise'
    )
    (tmp_path / "one.toml").write_text(text)
    one = Rig.load(str(tmp_path / "one.toml"))
    time = PERIOD * np.arange(400)
    turn = np.stack([0.0 * time, 0.0 * time, np.sin(time), np.cos(time)], axis=1)
    poses = np.hstack([np.outer(np.sin(3.0 * time), [0.1, 0.2, 0.3]), turn])
    motion = Excitation("shaken", time, {"pose": poses})
    three = MjcfForward.of(whole).simulate(motion, {})
    np.testing.assert_array_equal(MjcfForward.of(one).simulate(motion, {}), three[:, [0, 1, 2, 5]])


def test_a_ball_joint_that_is_fed_in_is_refused_with_what_stands_for_it(tmp_path):
    with pytest.raises(InvalidInputError, match="three hinges"):
        rig_of(tmp_path, '<joint name="base" type="ball"/>')
