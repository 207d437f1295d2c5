"""URDF files as they are met: an inertia that no body has is told and replaced, a word refused."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

from ves_twin.core.errors import InvalidInputError
from ves_twin.machines.mjcf.draft.given_model import GivenModel

URDF = """
<robot name="arm">
  <link name="base"/>
  <joint name="j1" type="revolute"><parent link="base"/><child link="link1"/>
    <axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="10" velocity="5"/></joint>
  <link name="link1"><inertial><origin xyz="0.1 0 0"/><mass value="2"/>
    <inertia ixx="{}" iyy="{}" izz="{}" ixy="{}" ixz="0" iyz="0"/></inertial></link>
</robot>
"""
NO_BODY = "no body has the inertia of link1"


def read(folder: Path, *numbers: float | str) -> GivenModel:
    """What is made of an arm of one link with these numbers of inertia."""
    path = folder / "arm.urdf"
    path.write_text(URDF.format(*numbers))
    return GivenModel.read(path)


@pytest.mark.parametrize("numbers", [(0.01, 0.02, 0.05, 0.0), (0.02, 0.02, 0.03, 0.025)])
def test_an_inertia_that_no_body_has_is_told_and_the_nearest_one_taken(tmp_path, numbers):
    given = read(tmp_path, *numbers)
    assert any(NO_BODY in note for note in given.notes)
    inertia = mujoco.MjModel.from_xml_string(given.text).body("link1").inertia
    assert np.all(inertia > 0.0)
    assert 2.0 * inertia.max() < inertia.sum()
    # half the shortfall of 0.02 goes to two axes each: nothing moves further than it lacked
    assert abs(inertia.sum() - sum(numbers[:3])) < 0.021


def test_an_inertia_that_a_body_has_stays_as_it_is_told(tmp_path):
    given = read(tmp_path, 0.02, 0.03, 0.05, 0.0)
    assert not any(NO_BODY in note for note in given.notes)
    inertia = mujoco.MjModel.from_xml_string(given.text).body("link1").inertia
    assert np.allclose(np.sort(inertia), [0.02, 0.03, 0.05], rtol=1e-6)


@pytest.mark.parametrize("word", ["heavy", "nan"])
def test_a_word_for_a_number_is_refused_in_one_line(tmp_path, word):
    with pytest.raises(InvalidInputError) as told:
        read(tmp_path, word, 0.03, 0.05, 0.0)
    assert word in str(told.value)
    assert "\n" not in str(told.value)


@pytest.mark.parametrize(("aside", "told"), [("0 0 0", True), ("0 0 0.05", False)])
def test_centres_that_all_lie_in_their_joints_are_asked_after(tmp_path, aside, told):
    """A published arm of six axes: its weight was none, 10 N m off at the shoulder."""
    inertia = '<mass value="2"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
    links = ""
    for i, above in enumerate(("base", "l0", "l1")):
        place = aside if i == 2 else "0 0 0"
        links += f'<link name="l{i}"><inertial><origin xyz="{place}"/>{inertia}</inertial></link>'
        links += f'<joint name="j{i}" type="revolute"><parent link="{above}"/>'
        links += f'<child link="l{i}"/><axis xyz="0 1 0"/></joint>'
    path = tmp_path / "arm.urdf"
    path.write_text(f'<robot name="arm"><link name="base"/>{links}</robot>')
    notes = GivenModel.read(path).notes
    assert any("centre of mass in their joint" in note for note in notes) is told


def test_wheels_beside_each_other_have_their_centres_where_they_turn(tmp_path):
    inertia = '<mass value="2"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
    wheels = "".join(
        f'<link name="w{i}"><inertial>{inertia}</inertial></link><joint name="j{i}"'
        f' type="continuous"><parent link="base"/><child link="w{i}"/><axis xyz="0 1 0"/></joint>'
        for i in range(4)
    )
    path = tmp_path / "rover.urdf"
    path.write_text(f'<robot name="rover"><link name="base"/>{wheels}</robot>')
    assert not any("centre of mass" in note for note in GivenModel.read(path).notes)
