"""Angles that leave the stops of their joints as radians, and none as degrees, are degrees."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from drafted import drafted
from three_joints import ARM

from ves_twin.machines.mjcf.draft.changes import _before_gears
from ves_twin.machines.mjcf.draft.match import Match
from ves_twin.machines.mjcf.draft.spots import Quantity, Spot

DEGREES = 180.0 / np.pi
REACH = {"turn": 1.6, "lift": 1.2, "bend": 1.6}


@pytest.fixture
def stopped(tmp_path):
    """The arm with stops."""
    text = ARM
    for name, most in REACH.items():
        text = text.replace(f'name="{name}"', f'name="{name}" range="{-most} {most}"')
    path = tmp_path / "stopped.xml"
    path.write_text(text.replace("<worldbody>", '<compiler angle="radian"/><worldbody>'))
    return path


def look(stopped, write, columns, factor):
    """What a draft says of the arm, whose torques are friction, and the factors of its angles."""
    new = {n: v * factor if n[0] == "q" else v for n, v in columns.items() if n[0] != "d"}
    for torque, angle in (("tau1", "q1"), ("tau2", "q2"), ("tau3", "q3")):
        new[torque] = new[torque] + 30.0 * np.sign(np.gradient(columns[angle]))
    found, rig = drafted(stopped, write(new))
    return " ".join(found.look), {s.scale for s in rig.description.signals.values() if s.joint}


def test_an_arm_whose_torques_are_all_friction_is_in_degrees_by_its_stops(stopped, write, columns):
    """Of a measured arm torques were friction, and seven motors before their gears were told."""
    words, scales = look(stopped, write, columns, DEGREES)
    assert "q1, q2, q3: the numbers fit the stops of the joints as deg" in words
    assert list(scales) == pytest.approx([1.0 / DEGREES])


def test_angles_before_a_gear_of_a_hundred_are_no_degrees(stopped, write, columns):
    words, _ = look(stopped, write, columns, 300.0)
    assert "as deg" not in words
    assert "a motor before its gear?" in words


def test_an_angle_a_little_beyond_its_stop_may_have_another_zero(stopped, write, columns):
    """Zeros of a youBot in another pose went unheard of; files round stops, by a tenth or less."""
    moved = {**columns, "q3": columns["q3"] + 0.6 * REACH["bend"]}
    words, _ = look(stopped, write, moved, 1.0)
    assert "another zero, sign, or joint?" in words
    assert "a motor before its gear?" not in words


def test_angles_within_their_stops_stay_what_they_are(stopped, write, columns):
    words, scales = look(stopped, write, columns, 1.0)
    assert "stops of the joints" not in words
    assert scales == {1.0}


def test_an_effort_beyond_what_its_joint_may_have_is_asked_after(arm, write, columns):
    """A URDF gives joints an effort limit: torques in kilonewton metres, or of a motor's shaft."""
    most = {f"tau{n + 1}": 2.0 * np.max(np.abs(columns[f"tau{n + 1}"])) for n in range(3)}
    text = ARM
    for limit, name in zip(most.values(), REACH, strict=True):
        limits = f'actuatorfrcrange="{-limit} {limit}" actuatorfrclimited="false"'
        text = text.replace(f'joint name="{name}"', f'joint name="{name}" {limits}')
    arm.write_text(text)
    assert not any("whose limit is" in words for words in drafted(arm, write(columns))[0].look)
    found, _ = drafted(arm, write(columns | {"tau2": 4.0 * columns["tau2"]}))
    assert [w.split(" ")[0] for w in found.look if "at lift, whose limit is" in w] == ["tau2"]


CLIPPED = """
<mujoco>
  <worldbody><body><joint name="rail" type="slide"/><geom size="0.1" mass="2"/></body></worldbody>
  <actuator><motor name="drive" joint="rail" gear="50" ctrllimited="true" ctrlrange="-12 12"/>
  </actuator>
</mujoco>
"""


def of_the_rail(tmp_path, write, **columns):
    """What a draft of a carriage says, and its file."""
    path = tmp_path / "rail.xml"
    path.write_text(CLIPPED)
    time = 0.01 * np.arange(1000)
    pull = 8.0 * np.sign(np.sin(1.3 * time)) * np.sin(0.4 * time) ** 2
    speed = np.cumsum(25.0 * pull) * 0.01
    log = {"t": time, "x_m": np.cumsum(speed - speed.mean()) * 0.01, "drive_duty": pull}
    return drafted(path, write(log | {n: f(log) for n, f in columns.items()}))


@pytest.mark.parametrize("told", ["N", ""])
def test_an_effort_is_held_against_no_range_of_commands(tmp_path, write, told):
    """400 N of a motor with 50 N a unit are 8 units of 12."""
    found, _ = of_the_rail(
        tmp_path,
        write,
        **{f"drive_{told}" if told else "force": lambda log: 50 * log["drive_duty"]},
    )
    assert not any("ctrlrange" in words for words in found.look)


def test_commands_that_the_model_would_clip_are_told(tmp_path, write):
    """Counts of a PWM for volts: MuJoCo holds them at the end of ctrlrange, and says nothing."""
    found, _ = of_the_rail(tmp_path, write, drive_duty=lambda log: 1e3 * log["drive_duty"])
    assert any(
        "drive takes -12 to 12 (ctrlrange), a simulation clips the rest" in w for w in found.look
    )
    found, _ = of_the_rail(tmp_path, write)
    assert not any("ctrlrange" in words for words in found.look)


@pytest.mark.parametrize(("unit", "told", "offered"), [("m", True, 0), ("m", False, 1)])
def test_a_length_is_no_angle_of_a_motor_before_its_gear(unit, told, offered):
    """The gear of a motor on a slide may be its constant, N per V: 3418 of a crane."""
    spot = Spot(Quantity.POSITION, "rail", "m", frozenset({"rail"}), 1)
    match = Match("x", spot, unit, told, 1.0, (), ())
    model = mujoco.MjModel.from_xml_string(CLIPPED)
    changes = [*_before_gears([match], [match], model)]
    assert len(changes) == offered
    assert all(new.scale == 0.02 for (new,), _ in changes)
