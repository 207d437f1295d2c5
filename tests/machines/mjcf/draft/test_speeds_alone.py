"""A reaction wheel tells its speed alone: signs, units and swaps of its machine are checked still."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from ves_twin.core.errors import InvalidInputError
from ves_twin.machines.mjcf.draft.draft import draft
from ves_twin.machines.mjcf.plausible.implausible import implausible
from ves_twin.machines.mjcf.recordings.columns import read_rig_recording
from ves_twin.machines.mjcf.rig.machine import Rig

PENDULUM = """
<mujoco>
  <option timestep="0.001" integrator="implicitfast"><flag contact="disable"/></option>
  <worldbody><body name="rod">
    <joint name="rod" axis="0 1 0" damping="0.01"/>
    <geom type="capsule" fromto="0 0 0 0 0 -0.4" size="0.01" mass="0.4"/>
    <body name="wheel" pos="0 0 -0.4"><joint name="wheel" axis="0 1 0" damping="0.0002"/>
      <geom type="cylinder" size="0.1 0.01" mass="0.6" euler="90 0 0"/></body>
  </body></worldbody>
  <actuator><motor name="rod_motor" joint="rod"/><motor name="wheel_motor" joint="wheel" gear="0.5"/></actuator>
</mujoco>
"""


@pytest.fixture(scope="module")
def log():
    """Columns of a pendulum with a driven pivot that its reaction wheel swings."""
    model, rng = mujoco.MjModel.from_xml_string(PENDULUM), np.random.default_rng(2)
    data, rows = mujoco.MjData(model), np.zeros((2000, 5))
    for k in range(len(rows)):
        drive = 0.3 * np.sin(0.031 * k + 1.0), 0.3 * np.sin(0.047 * k)
        noise = np.array([1e-4, 0.01]) * rng.standard_normal(2)
        rows[k] = 0.01 * k, data.qpos[0] + noise[0], data.qvel[1] + noise[1], *drive
        data.ctrl[:] = drive
        for _ in range(10):
            mujoco.mj_step(model, data)
    names = ("t", "rod_rad", "wheel_rad_s", "rod_motor_Nm", "wheel_motor_A")
    return dict(zip(names, rows.T, strict=True))


@pytest.fixture
def model(tmp_path):
    path = tmp_path / "wheel.xml"
    path.write_text(PENDULUM)
    return path


def test_a_log_that_is_right_is_left_as_it_is(log, model, write, tmp_path):
    found = draft(model, [write(log)], tmp_path / "rig.toml")
    assert not any("checked" in words or "turned" in words for words in found.look)
    assert found.mode.endswith("the speed of wheel is integrated")
    assert min(found.explained.values()) > 0.9


@pytest.mark.parametrize("column", ["rod_rad", "rod_motor_Nm", "wheel_motor_A"])
def test_a_wrong_sign_is_found_without_the_wheels_angle(log, model, write, tmp_path, column):
    found = draft(model, [write(log | {column: -log[column]})], tmp_path / "rig.toml")
    (words,) = (words for words in found.look if "turned" in words)
    assert column in words
    assert min(found.explained.values()) > 0.9


def test_an_extended_file_is_held_against_the_log_as_well(log, model, write, tmp_path):
    path = write(log)
    (tmp_path / "rig.toml").write_text(draft(model, [path], tmp_path / "rig.toml").text)
    rig = Rig.load(tmp_path / "rig.toml")
    assert implausible(rig, read_rig_recording(path, rig)) is None
    wrong = write(log | {"rod_motor_Nm": -log["rod_motor_Nm"]}, "wrong.csv")
    told = implausible(rig, read_rig_recording(wrong, rig))
    assert told is not None
    assert "the other sign of rod_motor.effort" in told.came
    with pytest.raises(InvalidInputError, match="sign"):
        raise told.error
