"""Columns of a five-bar linkage, whose drives tell all, are held against it as those of an arm."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from drafted import changed, drafted, scales

LINKAGE = """
<mujoco model="five_bar">
  <option timestep="0.0005" integrator="implicitfast"><flag contact="disable"/></option>
  <default><geom type="capsule" size="0.01" density="2700"/><joint axis="0 -1 0"/></default>
  <worldbody>
    <body name="left" pos="-0.1 0 0"><joint name="left"/><geom fromto="0 0 0 -0.1 0 0.25"/>
      <body name="left_rod" pos="-0.1 0 0.25"><joint name="left_rod"/>
        <geom fromto="0 0 0 0.2 0 0.25"/></body></body>
    <body name="right" pos="0.1 0 0"><joint name="right"/><geom fromto="0 0 0 0.1 0 0.25"/>
      <body name="right_rod" pos="0.1 0 0.25"><joint name="right_rod"/>
        <geom fromto="0 0 0 -0.2 0 0.25"/></body></body>
  </worldbody>
  <equality><connect body1="left_rod" body2="right_rod" anchor="0.2 0 0.25" solref="0.002 1"/>
  </equality>
  <actuator><motor name="left" joint="left"/><motor name="right" joint="right"/></actuator>
</mujoco>
"""

PERIOD = 0.005
"""Of the rows [s]."""

CONSTANT = 0.5
"""Of its motors [N m/A], which no file tells."""


@pytest.fixture(scope="module")
def run() -> dict[str, np.ndarray]:
    """Eight seconds of MuJoCo's forward dynamics under two servos, with 0.05 N m of friction."""
    model = mujoco.MjModel.from_xml_string(LINKAGE)
    data = mujoco.MjData(model)
    places = [model.joint(name).qposadr[0] for name in ("left", "right")]
    every, rows = round(PERIOD / model.opt.timestep), []
    for k in range(int(8.0 / model.opt.timestep)):
        t = data.time
        path = [np.sin(4.4 * t) + 0.5 * np.sin(11.9 * t), np.sin(5.7 * t) - 0.5 * np.sin(10.7 * t)]
        q, v = data.qpos[places], data.qvel[places]
        data.ctrl[:] = 60.0 * (0.25 * min(t, 1.0) * np.array(path) - q) - 3.0 * v
        if k % every == 0:
            rows.append([t, *q, *(data.ctrl + 0.05 * np.sign(v))])
        mujoco.mj_step(model, data)
    columns = np.array(rows).T
    rng = np.random.default_rng(4)
    columns[1:3] += 2e-5 * rng.standard_normal(columns[1:3].shape)
    columns[3:] += 0.01 * rng.standard_normal(columns[3:].shape)
    return dict(zip(("t", "q_left", "q_right", "tau_left", "tau_right"), columns, strict=True))


@pytest.fixture
def linkage(tmp_path):
    path = tmp_path / "five_bar.xml"
    path.write_text(LINKAGE)
    return path


def test_a_linkage_that_is_right_is_drafted_without_a_change(linkage, run, write):
    found, rig = drafted(linkage, write(run))
    assert set(scales(rig).values()) == {1.0}
    assert rig.description.drive.imposed == ("left", "right")
    assert found.look == ("clock t: no unit is given, s is a guess",)
    assert min(found.explained.values()) > 0.97


def test_a_turned_position_in_degrees_is_found(linkage, run, write):
    degrees = np.degrees(1.0) * run["q_right"]
    found, rig = drafted(linkage, write(changed(run, q_right=-degrees)))
    told = " ".join(found.look)
    assert "q_right counts against position of joint right of the model: it is turned" in told
    assert "q_right: numbers fit the model as deg, not as rad" in told
    assert scales(rig)["right.position"] == pytest.approx(-np.pi / 180.0)
    assert min(found.explained.values()) > 0.97


def test_constants_of_the_motors_are_read_off_what_the_whole_linkage_needs(linkage, run, write):
    left = {name: run[name] for name in ("t", "q_left", "q_right")}
    amperes = {"i_left_A": -run["tau_left"], "i_right_A": run["tau_right"]}
    log = write(left | {name: torque / CONSTANT for name, torque in amperes.items()})
    found, rig = drafted(linkage, log)
    assert scales(rig)["left.effort"] == pytest.approx(-CONSTANT, rel=0.02)
    assert scales(rig)["right.effort"] == pytest.approx(CONSTANT, rel=0.02)
    assert any("makes it fit this model, turned" in one for one in found.look)


def test_links_that_do_not_meet_where_a_log_goes_are_told(linkage, run, write):
    torques = {name: run[name] for name in ("tau_left", "tau_right")}
    wide = {f"{name}_rad": 3.0 * run[name] for name in ("q_left", "q_right")}
    found, rig = drafted(linkage, write({"t": run["t"]} | wide | torques))
    assert set(scales(rig).values()) == {1.0}
    assert any("the loops of the model do not close" in one for one in found.look)
    assert not any("times what the model needs" in one or "fit" in one for one in found.look)
