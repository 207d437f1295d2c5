"""A ball on a beam: its place and the servo's set-points are told, the beam's angle is not."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from drafted import drafted

from ves_twin.core.errors import InvalidInputError
from ves_twin.machines.mjcf.draft.draft import draft

BEAM = """
<mujoco model="beam">
  <option timestep="0.002" integrator="implicitfast"><flag contact="disable"/></option>
  <worldbody><body name="beam" pos="0 0 0.3">
    <joint name="tilt" axis="0 -1 0" damping="0.05" armature="0.01"/>
    <geom type="box" size="0.4 0.03 0.01" mass="1"/>
    <body name="ball"><joint name="roll" type="slide" axis="1 0 0" damping="{damping}"/>
      <geom type="sphere" size="0.015" mass="0.06"/></body></body></worldbody>
  <actuator><position name="motor" joint="tilt" kp="30" kv="4" {gear}/></actuator>
</mujoco>
"""
LINKS = """
<mujoco>
  <option timestep="0.002" integrator="implicitfast"><flag contact="disable"/></option>
  <worldbody><body><joint name="shoulder" axis="0 1 0" damping="0.05"/>
    <geom type="capsule" fromto="0 0 0 0 0 -0.3" size="0.02" mass="0.5"/>
    <body pos="0 0 -0.3"><joint name="elbow" axis="0 1 0" damping="0.02"/>
      <geom type="capsule" fromto="0 0 0 0 0 -0.25" size="0.02" mass="0.4"/></body></body>
  </worldbody>
  <actuator><motor name="drive" joint="shoulder"/></actuator>
</mujoco>
"""
HELD = 4
"""Rows for which a set-point stands."""


def text(gear: str = "", damping: float = 0.4) -> str:
    return BEAM.format(gear=gear, damping=damping)


def recorded(model: mujoco.MjModel) -> dict[str, np.ndarray]:
    """20 s of steps of the set-point, every 0.2 s another, at 20 Hz."""
    rng, data, rows = np.random.default_rng(5), mujoco.MjData(model), []
    command = 0.0
    for k in range(400):
        if k % HELD == 0:
            place = float(data.joint("roll").qpos[0])
            command = float(np.round(rng.uniform(-0.2, 0.2) + 0.6 * place, 3))
        rows.append([0.05 * k, command, float(data.joint("roll").qpos[0])])
        data.ctrl[:] = command
        mujoco.mj_step(model, data, 25)
    time, set_point, place = np.array(rows).T
    place = place + 1e-4 * rng.standard_normal(len(place))
    return {"time_s": time, "motor": set_point, "ball_m": place}


@pytest.fixture(scope="module")
def run() -> dict[str, np.ndarray]:
    return recorded(mujoco.MjModel.from_xml_string(text()))


@pytest.fixture
def beam(tmp_path):
    path = tmp_path / "beam.xml"
    path.write_text(text())
    return path


def test_causes_are_offered_where_a_motion_alone_is_told(beam, run, write):
    """Without an effort none of a joint had a size, and the ball, all that was seen, none at all."""
    _, rig = drafted(beam, write(run))
    kinds = {cause.effect for cause in rig.hypotheses if cause.target == "roll"}
    assert {"coulomb_friction", "viscous_friction", "quadratic_drag", "force_offset"} <= kinds
    speed = rig.description.typical.joint["roll"].speed
    assert 0.4 * speed <= rig.description.typical.joint["roll"].effort < 0.06 * 9.81


def test_a_weight_is_an_effort_where_no_damper_is(tmp_path, run, write):
    """M g sin of the beam's angle."""
    path = tmp_path / "free.xml"
    path.write_text(text(damping=0.0))
    _, rig = drafted(path, write(run))
    assert 0.05 < rig.description.typical.joint["roll"].effort < 0.06 * 9.81


def test_what_is_fed_in_is_held_and_no_repeated_reading(beam, run, write):
    """Drawn straight to the next one, a set-point began three rows before it was given."""
    found, rig = drafted(beam, write(run))
    assert rig.description.signals["motor.effort"].repeats == 1
    assert not any("a reading is repeated" in words for words in found.look)


def test_a_column_that_is_there_twice_is_told_as_that(beam, run, write):
    found, _ = drafted(beam, write(run | {"ball2": run["ball_m"]}))
    assert any("ball2 is ball_m once more" in words for words in found.look)


@pytest.mark.parametrize(
    "told", [("v_shoulder",), ("q_shoulder", "v_elbow"), ("v_shoulder", "v_elbow")]
)
def test_a_joint_without_an_effort_has_a_size_where_speeds_are_told(tmp_path, write, told):
    """By its speed summed up: no row tells where a joint begins of which a speed alone is read."""
    path = tmp_path / "arm.xml"
    path.write_text(LINKS)
    model = mujoco.MjModel.from_xml_string(LINKS)
    data, rows = mujoco.MjData(model), []
    for k in range(800):
        command = 0.6 * np.sin(0.02 * k) + 0.3 * np.sin(0.071 * k)
        rows.append([0.01 * k, command, *data.qpos, *data.qvel])
        data.ctrl[:] = command
        mujoco.mj_step(model, data, 5)
    names = ("t_s", "drive_Nm", "q_shoulder", "q_elbow", "v_shoulder", "v_elbow")
    every = dict(zip(names, np.array(rows).T, strict=True))
    log = {
        {"q": f"{n}_rad", "v": f"{n}_rad_s"}.get(n[0], n): v
        for n, v in every.items()
        if n in ("t_s", "drive_Nm", *told)
    }
    _, rig = drafted(path, write(log))
    assert 0.05 < rig.description.typical.joint["elbow"].effort < 2.0


def test_a_servo_with_a_gear_is_refused_by_that(tmp_path, run, write):
    path = tmp_path / "geared.xml"
    path.write_text(text('gear="2.7"'))
    columns = {{"motor": "motor_cmd_deg"}.get(n, n): v for n, v in run.items()}
    with pytest.raises(
        InvalidInputError, match=r"motor has gear 2.7, .* with gear 1: write them in rad"
    ):
        draft(path, [write(columns)], tmp_path / "rig.toml")
