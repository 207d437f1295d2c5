"""Parameter files: every number is complete, wrong ones are refused in one clear line."""

import numpy as np
import pytest

from ves_twin.core.errors import InvalidInputError, UnknownNameError, VersionError, VesTwinError
from ves_twin.plant.parameters import Grade, parse_parameters, read_plant_file
from ves_twin.plant.plant import Plant, mjcf_part

NAMES = sorted(Plant.load("ves2").parameters)
ENTRY = {"value": "9.81", "unit": '"m/s^2"', "sd": "0.0", "grade": '"thesis"', "source": '"x"'}


@pytest.fixture(scope="module")
def table(plant):
    return plant.parameters


@pytest.fixture
def load(tmp_path):
    """A plant file with one parameter, some of its keys changed."""

    def build(**changes):
        entry = {**ENTRY, **changes}
        body = "".join(f"{key} = {value}\n" for key, value in entry.items() if value is not None)
        path = tmp_path / "rig.toml"
        path.write_text(f"schema = 1\n[gravity]\n{body}")
        return parse_parameters(read_plant_file(path), path)["gravity"]

    return build


def refused(action, *words):
    """The action is refused with one line that holds all words."""
    with pytest.raises(VesTwinError) as caught:
        action()
    text = str(caught.value)
    assert "\n" not in text
    for word in words:
        assert word in text
    return caught.value


@pytest.mark.parametrize("name", NAMES)
def test_every_parameter_is_complete(table, name):
    entry = table[name]
    assert entry.name == name
    assert entry.unit
    assert entry.source.strip()
    assert entry.grade in set(Grade)
    assert entry.sd.shape == entry.value.shape
    assert np.all(entry.sd >= 0.0)
    assert np.all(np.isfinite(entry.sd))
    assert np.all(np.isfinite(entry.value))
    assert np.all((entry.low <= entry.value) & (entry.value <= entry.high))


def test_every_unit_is_one_that_exists(table):
    from pint import UnitRegistry

    registry = UnitRegistry()
    for entry in table.values():
        for unit in entry.unit.split(","):
            registry.Unit(unit)  # raises UndefinedUnitError


@pytest.mark.parametrize("name", NAMES)
def test_values_cannot_be_written_over(table, name):
    with pytest.raises(ValueError, match="read-only"):
        table[name].value[...] = 0.0


def test_numbers_that_the_thesis_prints_are_graded_as_thesis(table):
    printed = {"gravity": 9.81, "arm.d0": 0.22844, "arm.a2": 0.4318, "sensor.corner": 20.0}
    for name, value in printed.items():
        assert table[name].grade == Grade.THESIS
        assert table.number(name) == value


@pytest.mark.parametrize(
    ("name", "value", "word"),
    [
        ("leg.rod_mass", -1.0, "at least 0 kg"),
        ("leg.rod_mass", "-1 kg", "at least 0 kg"),
        ("leg.rod_mass", "3 mm", "kg"),
        ("leg.rod_mass", "three", "kg"),
        ("leg.rod_mass", "", "kg"),
        ("leg.rod_mass", None, "kg"),
        ("leg.rod_mass", True, "kg"),
        ("leg.rod_mass", float("nan"), "finite"),
        ("leg.rod_mass", "nan", "finite"),
        ("leg.rod_mass", float("inf"), "finite"),
        ("leg.rod_mass", [1.0, 2.0], "single number"),
        ("arm.mass", [1.0, 2.0, 3.0], "shape (4,)"),
        ("arm.mass", 3.0, "shape (4,)"),
        ("arm.mass", [1.0, 2.0, 3.0, -4.0], "at least 0"),
        ("arm.com", [[0.0, 0.0, 0.0], [0.0]], "one shape"),
        ("sensor.position", [0.0, 0.0, float("nan")], "[3]"),
        ("clock.leg_ticks", 0, "at least 1"),
    ],
)
def test_a_wrong_value_is_refused(table, name, value, word):
    refused(lambda: table.with_values({name: value}), name, word)


@pytest.mark.parametrize(
    ("name", "value"), [("leg.rod_mass", "inf"), ("sensor.offset", ["inf"] * 6)]
)
def test_infinity_as_text_is_refused(table, name, value):
    refused(lambda: table.with_values({name: value}), name, "finite")


def test_a_text_with_another_unit_is_converted(table):
    assert table.with_values({"leg.rod_length": "61 cm"}).number("leg.rod_length") == 0.61
    turned = table.with_values({"platform.base_half_angle": "180 deg"})
    assert turned.number("platform.base_half_angle") == pytest.approx(np.pi, rel=1e-15)


def test_moments_of_a_wrench_take_the_unit_of_a_moment(table):
    offset = ["1 N", "2 N", "3 N", "4 N*m", "5 N*m", "6 N*m"]
    changed = table.with_values({"sensor.offset": offset})
    np.testing.assert_array_equal(changed.array("sensor.offset"), [1, 2, 3, 4, 5, 6])


def test_an_array_is_taken_like_a_list(table):
    position = np.array([0.0, 0.0, 0.2])
    changed = table.with_values({"sensor.position": position})
    np.testing.assert_array_equal(changed.array("sensor.position"), position)


def test_one_number_for_each_leg_is_that_of_all_legs(table):
    six = [1e-12, 2e-12, 3e-12, 0.0, 0.0, 0.0]
    changed = table.with_values({"chamber.leakage": six})
    np.testing.assert_array_equal(changed.array("chamber.leakage"), six)
    alike = table.with_values({"chamber.leakage": 2e-12})
    np.testing.assert_array_equal(alike.array("chamber.leakage"), [2e-12] * 6)
    assert alike.number("chamber.leakage") == 2e-12
    refused(lambda: changed.number("chamber.leakage"), "chamber.leakage", "same value for all legs")
    refused(lambda: table.with_values({"chamber.leakage": [1e-12] * 5}), "shape (6,)")


def test_an_entry_of_each_leg_is_read_from_one_number_or_six(load):
    assert load(each='"leg"').value.tolist() == [9.81] * 6
    assert load(each='"leg"', sd="0.1").sd.tolist() == [0.1] * 6
    assert load(each='"leg"', value="[1, 2, 3, 4, 5, 6]").value.tolist() == [1, 2, 3, 4, 5, 6]
    refused(lambda: load(each='"leg"', value="[1, 2]"), "gravity", "6")
    refused(lambda: load(each='"arm"'), "gravity.each", "leg")


def test_a_share_takes_per_cent(table):
    changed = table.with_values({"hydraulics.valve_deadband": "0.5 %"})
    assert changed.number("hydraulics.valve_deadband") == pytest.approx(0.005)


def test_an_unknown_parameter_is_answered_with_the_nearest(table):
    for action in (
        lambda: table["leg.rod_mas"],
        lambda: table.with_values({"leg.rod_mas": 2.0}),
    ):
        assert isinstance(refused(action, "'leg.rod_mass'"), UnknownNameError)


def test_changing_one_value_leaves_the_old_table_and_the_others_alone(table):
    changed = table.with_values({"leg.rod_mass": 2.7})
    assert table.number("leg.rod_mass") == 2.5
    assert list(table.differences(changed)) == ["leg.rod_mass"]
    here, there = table.differences(changed)["leg.rod_mass"]
    assert (here, there) == (2.5, 2.7)


def test_an_array_from_the_table_is_a_copy(table):
    array = table.array("arm.mass")
    array[:] = 0.0
    assert table.array("arm.mass")[0] == 54.5


def test_a_complete_entry_is_read(load):
    entry = load(value='"981 cm/s^2"', sd="0.5", low="1.0", high="20")
    assert entry.value == pytest.approx(9.81)
    assert (entry.sd, entry.low, entry.high) == (0.5, 1.0, 20.0)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"unit": None}, ["gravity.unit"]),
        ({"sd": None}, ["gravity.sd"]),
        ({"grade": None}, ["gravity.grade"]),
        ({"source": None}, ["gravity.source"]),
        ({"grade": '"derivd"'}, ["derivd", "'derived'"]),
        ({"vale": "3"}, ["vale", "'value'"]),
        ({"value": "30.0", "high": "20"}, ["at most 20"]),
        ({"value": "nan"}, ["finite"]),
        ({"value": "[]"}, ["one shape"]),
        ({"value": '"9.81 m"'}, ["m/s^2"]),
        ({"sd": "-1.0"}, ["sd"]),
        ({"sd": "[1.0, 2.0]"}, ["sd"]),
        ({"low": "[1.0, 2.0]"}, ["low"]),
        ({"source": '""'}, ["source"]),
        ({"unit": '"foo"'}, ["unit"]),
    ],
    ids=str,
)
def test_a_wrong_entry_of_a_plant_file_is_refused(load, changes, words):
    refused(lambda: load(**changes), *words)


@pytest.mark.parametrize("schema", ["schema = 2", "schema = '1'", ""])
def test_a_plant_file_of_another_version_is_refused(tmp_path, schema):
    path = tmp_path / "rig.toml"
    path.write_text(f"{schema}\nname = 'x'\n")
    error = refused(lambda: read_plant_file(path), "rig.toml", "(1)")
    assert isinstance(error, VersionError)


def test_a_file_that_is_not_toml_is_refused(tmp_path):
    path = tmp_path / "rig.toml"
    for content in (b"schema = ", b"\xff\xfe\x00", b"schema = 1\nschema = 1\n"):
        path.write_bytes(content)
        assert isinstance(refused(lambda: read_plant_file(path), "TOML"), InvalidInputError)


def test_a_file_nested_too_deeply_is_refused(tmp_path):
    path = tmp_path / "rig.toml"
    path.write_text("a = " + "[" * 20000)
    refused(lambda: read_plant_file(path), "rig.toml")


def test_a_number_outside_a_table_is_refused(tmp_path):
    path = tmp_path / "rig.toml"
    path.write_text("schema = 1\ngravty = 9.81\n")
    refused(lambda: Plant.load(str(path)), "gravty", "a table with value and unit")


def test_the_files_of_the_parts_exist():
    for file in ("frame.xml", "leg.xml", "platform.xml", "sensor.xml", "puma560.xml"):
        assert mjcf_part(file).is_file()
