"""Angles that leave the stops of their joints as radians, and none as degrees, are degrees."""

from __future__ import annotations

import numpy as np
import pytest
from drafted import drafted
from three_joints import ARM

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


def test_angles_within_their_stops_stay_what_they_are(stopped, write, columns):
    words, scales = look(stopped, write, columns, 1.0)
    assert "stops of the joints" not in words
    assert scales == {1.0}
