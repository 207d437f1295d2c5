"""Scenario files: shipped ones are whole, wrong ones are refused in one clear line."""

import math
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ves_twin.core.errors import FileAccessError, UnknownNameError, VesTwinError
from ves_twin.core.resources import resource_folder
from ves_twin.mechanics.emulated import EmulatedSystem
from ves_twin.plant.plant import Plant
from ves_twin.scenario.load import parse_setting, scenario_questions
from ves_twin.scenario.schema import Scenario

FILES = [resource_folder("scenarios") / f"{name}.toml" for name in scenario_questions()]
MOVES = [{"start": 0.0, "duration": 2.0, "to": [0, 0, 0]}]
SINE = "position_sine"
BEAM = "beam_horizontal_truth"

fixed = settings(deadline=None, derandomize=True, max_examples=200)


@pytest.fixture
def write(tmp_path):
    def build(text: str) -> str:
        path = tmp_path / "my_run.toml"
        path.write_text(text)
        return str(path)

    return build


def refused(action, *words):
    with pytest.raises(VesTwinError) as caught:
        action()
    text = str(caught.value)
    assert "\n" not in text
    for word in words:
        assert word in text
    return caught.value


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_every_scenario_loads_and_what_it_names_exists(path):
    scenario = Scenario.load(path.stem)
    assert scenario.name == path.stem
    assert Plant.load(scenario.plant).with_values(scenario.parameters)
    assert Plant.load(scenario.belief)
    if scenario.platform.mode == "position":
        assert scenario.platform.emulated is None
    else:
        assert EmulatedSystem.load(scenario.platform.emulated).name == scenario.platform.emulated


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_every_scenario_opens_with_its_question(path):
    first = path.read_text(encoding="utf-8").splitlines()[0]
    assert first.startswith("# ")
    assert first.endswith("?")
    question = first.removeprefix("# ")
    assert Scenario.load(path.stem).question == question
    assert scenario_questions()[path.stem] == question


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_a_scenario_is_the_same_by_name_and_by_path(path):
    assert Scenario.load(str(path)) == Scenario.load(path.stem)


def test_texts_with_units_equal_si_numbers():
    texts = Scenario.load(
        SINE,
        {
            "run.duration": "2 min",
            "arm.start": ["180 deg", "0.5 turn", "1 rad"],
            "platform.start": ["20 mm", "-1 cm", 0.0, "10 deg", 0.0, "-20 deg"],
            "platform.rate": "0.08 kHz",
        },
    )
    numbers = Scenario.load(
        SINE,
        {
            "run.duration": 120.0,
            "arm.start": [math.pi, math.pi, 1.0],
            "platform.start": [0.02, -0.01, 0.0, math.radians(10), 0.0, math.radians(-20)],
            "platform.rate": 80.0,
        },
    )
    for one, two in (
        (texts.run.duration, numbers.run.duration),
        (texts.arm.start, numbers.arm.start),
        (texts.platform.start, numbers.platform.start),
        (texts.platform.rate, numbers.platform.rate),
    ):
        assert one == pytest.approx(two, rel=1e-14)  # two roundings of pint


def test_a_change_replaces_one_key_and_nothing_else():
    plain, changed = Scenario.load(BEAM), Scenario.load(BEAM, {"legs.gain": 16.0})
    assert plain.legs.gain == 12.6
    assert changed.legs.gain == 16.0
    assert changed.model_dump(exclude={"legs"}) == plain.model_dump(exclude={"legs"})
    assert changed.legs.filter == plain.legs.filter


def test_a_change_may_create_a_table_that_the_file_lacks():
    assert Scenario.load(SINE, {"gravity.age": 3}).gravity.age == 3


def test_changed_parameters_keep_their_dots():
    scenario = Scenario.load(BEAM, {"parameters.leg.rod_mass": 2.7, "parameters.gravity": 9.8})
    assert scenario.parameters == {"leg.rod_mass": 2.7, "gravity": 9.8}


def test_a_scenario_cannot_be_changed_after_loading():
    scenario = Scenario.load(SINE)
    with pytest.raises(ValueError, match="frozen"):
        scenario.run.duration = 3.0


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"rnu.duration": 1}, ["'rnu'", "'run'"]),
        ({"run.durtion": 1}, ["'run.durtion'", "'run.duration'"]),
        ({"legs.gian": 1}, ["'legs.gian'", "'legs.gain'"]),
        ({"platform.motion.amplitued": 1}, ["'platform.motion.amplitude'"]),
        ({"arm.moves": [{**MOVES[0], "speed": 1}]}, ["arm.moves.0.speed"]),
    ],
    ids=str,
)
def test_an_unknown_key_is_answered_with_the_nearest(changes, words):
    assert isinstance(refused(lambda: Scenario.load(SINE, changes), *words), UnknownNameError)


def test_a_misspelt_required_key_is_answered_with_the_nearest():
    moves = [{"strat": 0.0, "duration": 2.0, "to": [0, 0, 0]}]
    refused(lambda: Scenario.load(SINE, {"arm.moves": moves}), "strat", "'arm.moves.0.start'")


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("platform.mode", "positon", ["'position'"]),
        ("gravity.method", "truht", ["'truth'"]),
        ("legs.filter", "eror", ["'error'"]),
        ("run.log", "tik", ["'tick'"]),
        ("platform.motion.kind", "sinus", ["sine"]),
    ],
)
def test_an_unknown_choice_is_answered_with_what_exists(key, value, words):
    refused(lambda: Scenario.load(SINE, {key: value}), key, *words)


@pytest.mark.parametrize(
    ("key", "value", "word"),
    [
        ("run.duration", -1.0, "greater than 0"),
        ("run.duration", 0.0, "greater than 0"),
        ("run.duration", float("nan"), "finite"),
        ("run.duration", float("inf"), "finite"),
        ("run.duration", "nan", "finite"),
        ("run.duration", "5 m", "in s"),
        ("run.duration", "soon", "in s"),
        ("run.duration", [1.0], "in s"),
        ("run.duration", True, "in s"),
        ("run.settle", -2.0, "greater than 0"),
        ("run.substeps", 0, "1"),
        ("run.substeps", 65, "64"),
        ("run.substeps", 1.5, "integer"),
        ("run.seed", -1, "0"),
        ("run", 3, "dictionary"),
        ("platform.start", [0.0] * 5, "6 numbers"),
        ("platform.start", 0.1, "6 numbers"),
        ("platform.start", "home", "6 numbers"),
        ("platform.start", [0, 0, 0, "3 m", 0, 0], "[4]"),
        ("platform.start", ["3 deg", 0, 0, 0, 0, 0], "[1]"),
        ("platform.start", [0, 0, 0, 0, 0, float("nan")], "finite"),
        ("platform.rate", 0.0, "greater than or equal to 1"),
        ("platform.rate", 1001.0, "1000"),
        ("platform.rate", "80 m", "in Hz"),
        ("platform.motion.frequency", [1.0, 2.0], "6"),
        ("platform.motion.fade", -1.0, "0"),
        ("gravity.age", -1, "0"),
        ("gravity.age", 51, "50"),
        ("legs.gain", -1.0, "0"),
        ("legs.gain", "12.6 m", "1/s"),
        ("arm.start", [0.0, 0.0], "3 numbers"),
        ("arm.start", ["1 m", 0.0, 0.0], "rad"),
        ("arm.moves", 3, "tuple"),
        ("parameters", 3, "dictionary"),
        ("plant", 3, "string"),
        ("platform.mode", ["x"], "mode"),
        ("gravity.method", {}, "method"),
    ],
    ids=str,
)
def test_a_wrong_value_is_refused_with_its_key(key, value, word):
    refused(lambda: Scenario.load(SINE, {key: value}), "position_sine.toml", key, word)


def test_an_arm_has_a_path_or_moves_and_a_path_leaves_its_start():
    path = {"start": 0.0, "duration": 2.0, "through": [["10 deg", 0, 0]]}
    arm = Scenario.load(SINE, {"arm": {"path": path}}).arm
    assert arm.path.through == ((math.radians(10), 0.0, 0.0),)
    both = {"arm": {"path": path, "moves": MOVES}}
    refused(lambda: Scenario.load(SINE, both), "arm.moves, arm.path and arm.operator")
    still = {"arm": {"path": {**path, "through": [[0, 0, 0]]}}}
    refused(lambda: Scenario.load(SINE, still), "never leaves")
    refused(lambda: Scenario.load(SINE, {"arm": {"path": {**path, "through": []}}}), "through")


def test_moves_may_touch_but_not_overlap():
    touching = [*MOVES, {"start": 2.0, "duration": 1.0, "to": [1, 0, 0]}]
    assert len(Scenario.load(SINE, {"arm.moves": touching}).arm.moves) == 2
    for start in (1.9, 0.0):
        late = [*MOVES, {"start": start, "duration": 1.0, "to": [1, 0, 0]}]
        refused(lambda late=late: Scenario.load(SINE, {"arm.moves": late}), f"{start} s", "0.0 s")
    backward = [{"start": 5.0, "duration": 1.0, "to": [1, 0, 0]}, *MOVES]
    refused(lambda: Scenario.load(SINE, {"arm.moves": backward}), "arm")


@pytest.mark.parametrize(
    "move", [{"duration": 0.0}, {"duration": -1.0}, {"start": -1.0}, {"to": [0.0, 0.0]}], ids=str
)
def test_a_wrong_move_is_refused(move):
    key = f"arm.moves.0.{next(iter(move))}"
    refused(lambda: Scenario.load(SINE, {"arm.moves": [{**MOVES[0], **move}]}), key)


@pytest.mark.parametrize(
    ("name", "changes", "word"),
    [
        (SINE, {"platform.mode": "admittance"}, "needs platform.emulated"),
        (SINE, {"platform.emulated": "table_5_2"}, "emulates nothing"),
        (BEAM, {"platform.mode": "position"}, "emulates nothing"),
    ],
)
def test_a_mode_has_what_it_needs_and_nothing_else(name, changes, word):
    refused(lambda: Scenario.load(name, changes), "platform", word)


def test_only_a_micro_gravity_run_has_a_reference():
    assert Scenario.load(BEAM).has_reference
    assert not Scenario.load(BEAM, {"platform.mode": "admittance"}).has_reference
    assert not Scenario.load(SINE).has_reference


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[run]\nduration = 1.0\n", ["question"]),
        ("", ["question"]),
        ("# q?\n", ["run", "no default"]),
        ("# q?\n[run]\nduration = 1\n", ["platform"]),
        ("# q?\n[run\n", ["TOML"]),
        ("# q?\n[run]\nduration = 1\n[run]\n", ["TOML"]),
        ("# q?\na = " + "[" * 20000, ["TOML"]),
    ],
    ids=["no question", "empty", "no run", "no platform", "not TOML", "twice", "too deep"],
)
def test_a_wrong_file_is_refused(write, text, words):
    refused(lambda: Scenario.load(write(text), {}), "my_run.toml", *words)


def test_changing_a_parameter_of_a_file_whose_parameters_are_no_table_is_refused(write):
    path = write("# q?\nparameters = 3\n")
    refused(lambda: Scenario.load(path, {"parameters.gravity": 9.8}), "parameters")


def test_a_file_that_is_not_utf_8_is_refused(tmp_path):
    path = tmp_path / "my_run.toml"
    path.write_bytes(b"# caf\xe9?\n")
    refused(lambda: Scenario.load(str(path), {}), "TOML")


def test_a_missing_scenario_is_refused(tmp_path):
    with pytest.raises(UnknownNameError, match="did you mean 'position_sine'"):
        Scenario.load("postion_sine", {})
    with pytest.raises(FileAccessError):
        Scenario.load(str(tmp_path / "no.toml"), {})


@pytest.mark.parametrize(
    ("text", "setting"),
    [
        ("legs.gain=16", ("legs.gain", 16)),
        ("legs.gain = 16.5", ("legs.gain", 16.5)),
        ("run.noise=false", ("run.noise", False)),
        ("arm.start=[1, 2.0, '90 deg']", ("arm.start", [1, 2.0, "90 deg"])),
        ("run.duration=2 min", ("run.duration", "2 min")),
        ('run.duration="2 min"', ("run.duration", "2 min")),
        ("platform.mode=position", ("platform.mode", "position")),
        ("platform.mode =  position ", ("platform.mode", "position")),
        ("question=a=b", ("question", "a=b")),
        ("question=", ("question", "")),
    ],
)
def test_a_setting_is_read_as_toml_or_else_as_text(text, setting):
    key, value = parse_setting(text)
    assert (key, value) == setting
    assert type(value) is type(setting[1])


@pytest.mark.parametrize("text", ["legs.gain", "=16", "  = 16", ""])
def test_a_setting_without_key_or_equals_sign_is_refused(text):
    refused(lambda: parse_setting(text), "--set", "KEY=VALUE")


@fixed
@given(st.one_of(st.integers(-(2**62), 2**62), st.floats(allow_nan=False), st.booleans()))
def test_any_number_comes_back_from_a_setting(value):
    text = str(value).lower() if isinstance(value, bool) else repr(value)
    assert parse_setting(f"a.b={text}") == ("a.b", value)


@fixed
@given(st.text(max_size=30))
def test_any_text_is_a_setting_or_refused_in_one_line(text):
    try:
        key, _ = parse_setting(text)
    except VesTwinError as error:
        message = str(error)
        assert "\n" not in message
    else:
        assert key == text.partition("=")[0].strip() != ""


def test_settings_reach_the_scenario():
    changes = dict([parse_setting("run.duration=2 min"), parse_setting("legs.filter=error")])
    scenario = Scenario.load(BEAM, changes)
    assert scenario.run.duration == 120.0
    assert scenario.legs.filter == "error"


def test_names_do_not_depend_on_the_working_folder(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    assert Scenario.load(BEAM).plant == "ves2"
    assert Path.cwd() == tmp_path


def test_a_scenario_is_a_value():
    assert Scenario.load(BEAM) == Scenario.load(BEAM)
    assert Scenario.load(BEAM) != Scenario.load(BEAM, {"run.seed": 1})


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"platform.motion.band": [2.0, 1.0]}, "expected a band that holds six lines"),
        ({"platform.motion.band": [1.0, 1.2]}, "expected a band that holds six lines"),
        ({"platform.motion.kind": "multisin"}, "multisin"),
    ],
)
def test_a_wrong_multisine_is_one_clear_line(changes, words):
    with pytest.raises(VesTwinError, match=words):
        Scenario.load("identify_fast", changes)


def test_overlapping_way_points_are_refused():
    moves = [
        {"start": 0.0, "duration": 2.0, "to": [0.0] * 6},
        {"start": 1.0, "duration": 2.0, "to": [0.0] * 6},
    ]
    with pytest.raises(VesTwinError, match=r"starts before the one at 0\.0 s has ended"):
        Scenario.load("identify_slow", {"platform.motion.moves": moves})


def test_files_that_a_scenario_names_are_looked_for_beside_it_first(tmp_path, monkeypatch):
    rig = 'schema = 1\nbase = "{}"\n[parameters]\n"leg.rod_mass" = {}\n'
    (tmp_path / "deep").mkdir()
    (tmp_path / "deep" / "rig.toml").write_text(rig.format("base.toml", 2.6))
    (tmp_path / "deep" / "base.toml").write_text(rig.format("ves2", 2.7))
    (tmp_path / "rig.toml").write_text(rig.format("ves2", 2.8))  # of the same name, elsewhere
    for name in ("beam.toml", "calibration.toml", "moves.csv"):
        (tmp_path / "deep" / name).write_text("")
    path = tmp_path / "deep" / "mine.toml"
    path.write_text(
        '# Which files?\nplant = "rig.toml"\nbelief = "ves2"\n[run]\nduration = 1.0\n'
        '[platform]\nmode = "micro_gravity"\nemulated = "beam.toml"\n'
        '[gravity]\nmethod = "model"\nfile = "calibration.toml"\n[arm]\noperator = "moves.csv"\n'
    )
    monkeypatch.chdir(tmp_path)
    found = Scenario.load("deep/mine.toml")
    near = Path("deep")
    assert found.plant == str(near / "rig.toml")
    assert found.belief == "ves2"
    assert found.platform.emulated == str(near / "beam.toml")
    assert found.gravity.file == str(near / "calibration.toml")
    assert found.arm.operator == str(near / "moves.csv")
    assert Plant.load(found.plant).parameters.number("leg.rod_mass") == 2.6
    given = Scenario.load("deep/mine.toml", {"plant": "rig.toml"})
    assert Plant.load(given.plant).parameters.number("leg.rod_mass") == 2.8  # from the terminal
    (tmp_path / "deep" / "rig.toml").unlink()
    assert Scenario.load("deep/mine.toml").plant == "rig.toml"
