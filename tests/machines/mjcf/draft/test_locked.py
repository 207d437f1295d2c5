"""Joints without a column: locked where nothing measured hangs on them, and where they drive."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

from ves_twin.machines.mjcf.draft.draft import draft
from ves_twin.machines.mjcf.rig.machine import Rig

ARM = """
<mujoco>
  <worldbody>
    <body name="upper"><joint name="j1" axis="0 1 0"/>
      <geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.02" mass="1"/>
      <body name="lower" pos="0.3 0 0"><joint name="j2" axis="0 1 0"/>
        <geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.02" mass="0.6"/>
        <body name="left" pos="0.3 0 0"><joint name="left" type="slide" axis="0 1 0"/>
          <geom size="0.01" mass="{finger}"/></body>
        <body name="right" pos="0.3 0 0"><joint name="right" type="slide" axis="0 -1 0"/>
          <geom size="0.01" mass="{finger}"/></body>
      </body>
    </body>
  </worldbody>
  <equality>{equality}</equality>
  <actuator><motor name="m1" joint="j1"/><motor name="m2" joint="j2"/>{motor}</actuator>
</mujoco>
"""
MIMIC = '<joint joint1="left" joint2="right"/>'
GRIP = '<motor name="grip" joint="left"/>'


def log_of(folder: Path, text: str) -> tuple[Path, Path]:
    """A model, and an arm's motion with the torques that it needs, fingers at rest."""
    model = mujoco.MjModel.from_xml_string(text)
    data, time = mujoco.MjData(model), 0.005 * np.arange(1600)
    q = np.stack([0.8 * np.sin(1.3 * time), 0.9 * np.sin(1.7 * time + 1.0)], axis=1)
    v = np.gradient(q, time, axis=0)
    a = np.gradient(v, time, axis=0)
    rows = []
    for k in range(len(time)):
        data.qpos[:2], data.qvel[:2], data.qacc[:2] = q[k], v[k], a[k]
        mujoco.mj_inverse(model, data)
        rows.append([time[k], *q[k], *data.qfrc_inverse[:2]])
    (folder / "arm.xml").write_text(text)
    header = "t_s,j1_rad,j2_rad,m1_Nm,m2_Nm"
    np.savetxt(folder / "log.csv", rows, delimiter=",", header=header, comments="")
    return folder / "arm.xml", folder / "log.csv"


@pytest.mark.parametrize(
    ("finger", "equality", "motor"), [(0.02, "", ""), (0.4, "", GRIP), (0.4, MIMIC, GRIP)]
)
def test_fingers_that_no_column_tells_are_locked(tmp_path, finger, equality, motor):
    text = ARM.format(finger=finger, equality=equality, motor=motor)
    model, log = log_of(tmp_path, text)
    found = draft(model, [log], tmp_path / "rig.toml")
    locked = ["left", "right"] if equality or not motor else ["left"]
    if len(locked) == 2:
        assert found.mode.startswith("motion")
        assert 'locked = ["left", "right"]' in found.text
        assert all(share > 0.98 for share in found.explained.values())
    else:
        assert 'locked = ["left"]' in found.text
    assert any("taken as locked; if one moved" in words for words in found.look)


def test_a_heavy_part_that_nothing_drives_is_not_locked(tmp_path):
    model, log = log_of(tmp_path, ARM.format(finger=0.4, equality="", motor=""))
    found = draft(model, [log], tmp_path / "rig.toml")
    assert "locked" not in found.text
    assert any("no column tells the position of left, right" in words for words in found.look)


def test_a_load_that_the_model_ties_to_a_measured_joint_follows_it(tmp_path):
    """A worm drive's load was left out: a third of what was left was its weight."""
    text = """<mujoco><worldbody><body><joint name="motor" axis="0 0 1" damping="1e-3"/>
    <inertial pos="0 0 0" mass="0.1" diaginertia="1e-3 1e-3 1e-3"/></body>
    <body pos="0.1 0 0"><joint name="rope" type="slide" axis="0 0 1"/>
    <inertial pos="0 0 0" mass="2" diaginertia="1e-5 1e-5 1e-5"/></body></worldbody>
    <equality><joint joint1="rope" joint2="motor" polycoef="0 0.01 0.002 0 0"/></equality>
    <actuator><motor name="drive" joint="motor"/></actuator></mujoco>"""
    time = 0.005 * np.arange(1600)
    angle = np.sin(1.3 * time) + 0.3 * np.sin(4.1 * time)
    speed = np.gradient(angle, time)
    pull, slope = np.gradient(speed, time), 0.01 + 0.004 * angle
    rope = 2.0 * slope * (slope * pull + 0.004 * speed**2 + 9.81)
    torque = 1e-3 * pull + 1e-3 * speed + rope
    (tmp_path / "worm.xml").write_text(text)
    rows = np.column_stack([time, angle, torque])
    np.savetxt(tmp_path / "log.csv", rows, delimiter=",", header="t_s,motor_rad,drive_Nm")
    found = draft(tmp_path / "worm.xml", [tmp_path / "log.csv"], tmp_path / "rig.toml")
    assert "locked" not in found.text
    assert found.mode.startswith("motion")
    (words,) = (words for words in found.look if "equality" in words)
    assert words.startswith("rope follows motor as the model has it (equality)")
    assert min(found.explained.values()) > 0.99


def test_a_motor_behind_a_gear_is_drafted_by_the_position_of_its_load(tmp_path):
    """Typical sizes of the motor were 3e4 times too large: its effort was told, its angle not."""
    ratio, time = 500.0, 0.005 * np.arange(1600)
    text = f"""<mujoco><worldbody><body><joint name="motor" axis="0 0 1" damping="1e-4"/>
    <inertial pos="0 0 0" mass="0.1" diaginertia="1e-5 1e-5 1e-5"/></body>
    <body pos="0.1 0 0"><joint name="rod" type="slide" axis="1 0 0"/>
    <inertial pos="0 0 0" mass="20" diaginertia="1e-5 1e-5 1e-5"/></body></worldbody>
    <equality><joint joint1="rod" joint2="motor" polycoef="0 {1.0 / ratio} 0 0 0"/></equality>
    <actuator><motor name="drive" joint="motor"/></actuator></mujoco>"""
    place = 0.05 * np.sin(1.3 * time) + 0.01 * np.sin(4.1 * time)
    speed = np.gradient(place, time)
    pull = np.gradient(speed, time)
    torque = (1e-5 * ratio + 20.0 / ratio) * pull + 1e-4 * ratio * speed
    (tmp_path / "axis.xml").write_text(text)
    rows = np.column_stack([time, place, torque])
    np.savetxt(tmp_path / "log.csv", rows, delimiter=",", header="t_s,rod_m,drive_Nm")
    found = draft(tmp_path / "axis.xml", [tmp_path / "log.csv"], tmp_path / "rig.toml")
    assert found.mode.startswith("motion: every joint has a position and an effort")
    assert min(found.explained.values()) > 0.99
    (tmp_path / "rig.toml").write_text(found.text)
    typical = Rig.load(str(tmp_path / "rig.toml")).description.typical.joint
    assert typical["motor"].speed == pytest.approx(ratio * typical["rod"].speed, rel=1e-3)
    assert np.std(torque) < typical["motor"].effort <= 1.1 * np.max(np.abs(torque))
