"""Plants: loading by name, from a file, on a base; the hash follows the numbers."""

import dataclasses

import numpy as np
import pytest

from ves_twin.core.errors import FileAccessError, UnknownNameError, VesTwinError
from ves_twin.plant.plant import Plant, flat


@pytest.fixture
def write(tmp_path):
    def build(text):
        path = tmp_path / "rig.toml"
        path.write_text(text)
        return str(path)

    return build


def test_a_file_on_a_base_differs_by_what_it_lists(plant, write):
    path = write(
        'schema = 1\nbase = "ves2"\n[parameters]\n"leg.rod_mass" = 2.7\narm.d0 = "23 cm"\n'
    )
    rig = Plant.load(path)
    assert set(plant.parameters.differences(rig.parameters)) == {"leg.rod_mass", "arm.d0"}
    assert rig.parameters.number("leg.rod_mass") == 2.7
    assert rig.arm.d0 == pytest.approx(0.23, rel=1e-15)
    assert rig.name == "rig"


def test_a_base_file_may_carry_a_name(write):
    assert Plant.load(write('schema = 1\nname = "twin"\nbase = "ves2"\n')).name == "twin"


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ('schema = 1\nbase = "ves3"\n', "'ves2'"),
        ('schema = 1\nbase = "ves2"\n[parameters]\n"leg.rod_mas" = 2.7\n', "'leg.rod_mass'"),
        ('schema = 1\nbase = "ves2"\n[parameters]\n"leg.rod_mass" = -2.7\n', "at least 0"),
        ('schema = 1\nbase = "ves2"\n[leg.rod_mass]\nvalue = 2.7\n', "'leg'"),
        ('schema = 1\nbase = "ves2"\nparameters = 3\n', "a table of changed values"),
        ('schema = 1\nkind = "rig"\nname = "crane"\n', "compare, diagnose, trend and plan take"),
        ('schema = 2\nbase = "ves2"\n', "schema version 2"),
    ],
)
def test_a_wrong_base_file_is_refused_in_one_line(write, text, word):
    with pytest.raises(VesTwinError) as caught:
        Plant.load(write(text))
    assert word in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_file_that_is_its_own_base_is_refused(tmp_path):
    path = tmp_path / "rig.toml"
    path.write_text(f'schema = 1\nbase = "{path}"\n')
    with pytest.raises(VesTwinError):
        Plant.load(str(path))


def test_an_unknown_name_is_answered_with_the_nearest():
    with pytest.raises(UnknownNameError, match="did you mean 'ves2'"):
        Plant.load("vse2")


def test_a_path_that_does_not_exist_is_refused(tmp_path):
    for path in (tmp_path / "no.toml", tmp_path):
        with pytest.raises(FileAccessError):
            Plant.load(str(path))


def test_the_hash_is_the_same_for_the_same_numbers(plant):
    assert Plant.load("ves2").hash == plant.hash
    assert plant.with_values({"leg.rod_mass": 2.5}).hash == plant.hash
    assert dataclasses.replace(plant, name="other").hash == plant.hash


@pytest.mark.parametrize("name", sorted(Plant.load("ves2").parameters))
def test_the_hash_changes_with_any_number_by_its_smallest_step(plant, name):
    value = plant.parameters.array(name)
    whole = plant.parameters[name].unit == "1"
    changed = value + 1 if whole else np.nextafter(value, np.inf)
    assert plant.with_values({name: changed.tolist()}).hash != plant.hash


def test_nested_tables_become_dotted_names():
    nested = {"leg": {"rod_mass": 2.7, "hinge": {"x": 1}}, "gravity": 9.8}
    assert flat(nested) == {"leg.rod_mass": 2.7, "leg.hinge.x": 1, "gravity": 9.8}


def test_nested_and_dotted_changes_are_the_same(plant):
    nested = plant.with_values({"leg": {"rod_mass": 2.7}})
    assert nested.hash == plant.with_values({"leg.rod_mass": 2.7}).hash != plant.hash


def test_geometry_and_arm_follow_the_parameters(plant):
    wider = plant.with_values({"platform.base_radius": 0.8, "arm.a2": 0.5})
    np.testing.assert_allclose(np.hypot(*wider.geometry.base[:, :2].T), 0.8, rtol=0, atol=1e-15)
    np.testing.assert_allclose(np.hypot(*wider.geometry.top[:, :2].T), 0.5, rtol=0, atol=1e-15)
    assert wider.arm.a2 == 0.5
