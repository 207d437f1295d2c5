"""Columns go to the parts that their names and units mean: servos, legs, axes, rates."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from ves_twin.cli.new_text import new_text
from ves_twin.machines.mjcf.draft.changes import changes
from ves_twin.machines.mjcf.draft.draft import draft
from ves_twin.machines.mjcf.draft.match import Match
from ves_twin.machines.mjcf.draft.names import likeness
from ves_twin.machines.mjcf.draft.spots import Quantity, Spot
from ves_twin.machines.mjcf.rig.machine import Rig
from ves_twin.machines.new_machine import new_machine

LEGS = """
<mujoco model="legs">
  <option timestep="0.0005" integrator="implicitfast"><flag contact="disable"/></option>
  <worldbody>
    <body name="cart">
      <joint name="rail_x" type="slide" axis="1 0 0" damping="5"/>
      <joint name="rail_y" type="slide" axis="0 1 0" damping="5"/>
      <joint name="swing1a" axis="0 0 1" damping="0.5"/>
      <geom type="box" size="0.1 0.1 0.1" mass="2"/>
      <site name="imu"/>
      <body name="rod1"><joint name="slide1" type="slide" axis="0 0 1" damping="20"/>
        <geom type="box" size="0.02 0.02 0.1" mass="0.5"/></body>
      <body name="rod2"><joint name="slide2" type="slide" axis="0 0 1" damping="20"/>
        <geom type="box" size="0.02 0.02 0.1" mass="0.5"/></body>
    </body>
  </worldbody>
  <actuator>
    <position name="drive1" joint="slide1" kp="2000" kv="60"/>
    <position name="drive2" joint="slide2" kp="2000" kv="60"/>
    <motor name="push_x" joint="rail_x"/><motor name="push_y" joint="rail_y"/>
  </actuator>
  <sensor><gyro name="turn" site="imu"/></sensor>
</mujoco>
"""

HEAD = (
    "t [s],Leg2 setpoint (mm),Leg1 setpoint (mm),Leg2 length (mm),Leg1 length (mm),mocap_y_mm,"
    "mocap_x_mm,force_x_N,force_y_N,roll rate (deg/s),pitch rate (deg/s),yaw rate (deg/s)"
)


def logged(folder, head=HEAD):
    """A log of it, with the columns in another order than the model's."""
    model = mujoco.MjModel.from_xml_string(LEGS)
    data, rng, rows = mujoco.MjData(model), np.random.default_rng(5), []
    for time in np.arange(0.0, 6.0, 0.01):
        wave = np.sin(2.0 * np.pi * np.array([0.5, 0.7, 0.9, 0.4]) * time)
        data.ctrl[:] = wave * [0.02, 0.03, 4.0, 3.0] + [0.0, 0.0, 1.0, 0.0]
        mujoco.mj_forward(model, data)
        x, y, _, one, two = data.qpos
        mm = 1e3 * (np.array([two, one, y, x]) + 1e-5 * rng.standard_normal(4))
        gyro = np.rad2deg(data.sensordata + 1e-4 * rng.standard_normal(3))
        rows.append([time, *(1e3 * data.ctrl[[1, 0]]), *mm, *data.ctrl[2:], *gyro])
        mujoco.mj_step(model, data, 20)
    path = folder / "legs.csv"
    np.savetxt(path, rows, "%.9g", ",", header=head, comments="")
    (folder / "legs.xml").write_text(LEGS)
    return path


@pytest.fixture
def drafted(tmp_path):
    log = logged(tmp_path)
    return new_machine(tmp_path / "legs.xml", [log], tmp_path / "my.toml")


def taken(drafted):
    return {guess.column: guess.taken_for for guess in drafted.draft.guesses}


def test_what_a_servo_is_told_is_its_command_in_its_own_unit(drafted):
    found = taken(drafted)
    for n in (1, 2):
        assert found[f"Leg{n} setpoint (mm)"].startswith(f"actuator drive{n} [mm], fed in")
        assert found[f"Leg{n} length (mm)"].startswith(f"position of joint slide{n} [mm], compared")
    assert min(drafted.draft.explained[f"slide{n}.position"] for n in (1, 2)) > 0.99
    told = Rig.load(str(drafted.path)).description
    assert not told.drive.imposed
    assert told.signals["drive1.effort"].unit == "m"


def test_a_joint_goes_by_the_number_of_its_own_name_and_by_its_axis(drafted):
    found = taken(drafted)
    assert found["mocap_x_mm"].startswith("position of joint rail_x")
    assert found["mocap_y_mm"].startswith("position of joint rail_y")
    assert not any("swapped" in words for words in drafted.draft.look)


def test_three_rates_are_a_gyro_and_not_the_speeds_of_joints(drafted):
    found = taken(drafted)
    for axis, name in enumerate(("roll", "pitch", "yaw"), 1):
        assert found[f"{name} rate (deg/s)"].startswith(f"sensor turn, {axis} of 3")


def test_a_draft_of_which_the_model_explains_nothing_asks_to_look_at_its_columns(tmp_path, drafted):
    log = tmp_path / "legs.csv"
    words = "look whether each column is what it is taken for"
    assert words not in new_text(drafted, tmp_path / "legs.xml", [log])
    nothing = dict.fromkeys(drafted.draft.explained, 0.01)
    other = replace(drafted, draft=replace(drafted.draft, explained=nothing))
    assert words in new_text(other, tmp_path / "legs.xml", [log])


@pytest.mark.parametrize(("word", "unit"), [("angle", "m"), ("thetadot", "m/s"), ("stroke", "rad")])
def test_what_turns_is_no_slide_and_what_slides_no_hinge(word, unit):
    """`angle` of a pole on a cart was taken for the cart's place, `position` for the pole's."""
    quantity = Quantity.SPEED if unit.endswith("/s") else Quantity.POSITION
    other = unit.replace("m", "rad") if unit.startswith("m") else "m"
    wrong, right = (Spot(quantity, "joint", u, frozenset(), 1) for u in (unit, other))
    away, near = (likeness(word, "", spot, True, False) for spot in (wrong, right))
    assert away.score < 0.0 < near.score
    told = likeness(word, unit, wrong, True, False)
    assert told.score > 0.0  # what a unit says stands


@pytest.mark.parametrize(
    ("unit", "most", "driven", "offered"),
    [
        ("rad", 1.9, {"two"}, True),
        ("rad", 1.9, set(), False),
        ("rad", 40.0, set(), True),
        ("deg", 40.0, set(), False),
        ("deg", 1.9, set(), True),
    ],
)
def test_a_unit_that_a_name_says_stands_where_no_effort_of_its_joint_speaks(
    unit, most, driven, offered
):
    """An elbow on a belt was taken for 57 times smaller, as that explained its shoulder better."""
    spot = Spot(Quantity.POSITION, "two", "rad", frozenset(), 1)
    match = Match("q2", spot, unit, True, 1.0, ())
    model = mujoco.MjModel.from_xml_string(
        "<mujoco><worldbody><body><joint name='two'/><geom size='1'/></body></worldbody></mujoco>"
    )
    ways = [words for _, words in changes([match], driven, model, {"q2": most})]
    assert any(f"q2: named in {unit}, the numbers fit" in words for words in ways) is offered


def test_a_column_with_a_joint_s_whole_name_has_no_rivals_that_share_a_part_of_it(tmp_path):
    text = LEGS.replace("slide1", "leg_left_joint").replace("slide2", "leg_right_joint")
    head = HEAD.replace("Leg2 length", "leg_right_joint").replace("Leg1 length", "leg_left_joint")
    log = logged(tmp_path, head.replace("mocap_y_mm", "hall (K)"))
    (tmp_path / "legs.xml").write_text(text.replace("rail_y", "side_joint"))
    found = new_machine(tmp_path / "legs.xml", [log], tmp_path / "my.toml").draft
    (left,) = [guess for guess in found.guesses if guess.column == "leg_left_joint (mm)"]
    assert left.taken_for.startswith("position of joint leg_left_joint")
    assert "named as position of joint leg_left_joint" in left.why
    assert left.others == ""


def test_a_length_of_a_joint_that_turns_is_told_as_that(swing, write):
    """A flexible arm's deflection in metres, beside its hinge, was nearest to the motor."""
    path, columns = swing
    log = {{"q": "joint_deflection_m"}.get(name, name): rows for name, rows in columns.items()}
    log["q"] = columns["q"]
    found = draft(path, [write(log)], path.with_name("my.toml"))
    assert found.left["joint_deflection_m"].startswith(
        "joint joint has this name, but its position is in rad, not in m"
    )
