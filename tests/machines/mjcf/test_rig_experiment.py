"""Experiment files and import maps for rigs of two files: what they change, and one line where not."""

from __future__ import annotations

import json

import mujoco
import numpy as np
import pytest
from two_link import MODEL, TIME, programme, write_files

from ves_twin.cli.main import main
from ves_twin.core.errors import VesTwinError
from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.data.mapping.import_map import ImportMap
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.machines.machine import Material, Named
from ves_twin.machines.mjcf.mjcf_machine import MjcfMachine
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.recordings.applied import applied, rig_of
from ves_twin.machines.mjcf.recordings.experiment import MjcfExperiment
from ves_twin.machines.mjcf.recordings.read import read_recording
from ves_twin.machines.mjcf.rig.description import Mode
from ves_twin.machines.mjcf.rig.machine import Rig

MAP = """
schema = 1
[clock]
column = "Time (ms)"
[[channel]]
from = "F [kN]"
to = "drive.force"
[[channel]]
from = "m"
to = "hinge.torque"
unit = "N*m"
[[channel]]
from = "x [mm]"
to = "cart.position"
sign = -1
[[channel]]
from = "a [deg]"
to = "arm.angle"
"""


@pytest.fixture(scope="module")
def rig(tmp_path_factory):
    return Rig.load(str(write_files(tmp_path_factory.mktemp("rig"))))


@pytest.fixture(scope="module")
def moved(rig):
    """The rig's own motion under the test's efforts, as a recording."""
    forward = MjcfForward.of(rig)
    rows, fed = forward.simulate(programme(), {}), programme().drive
    names = [c.name for c in forward.channels]
    signals = {n: fed[n] for n in ("drive.force", "hinge.torque")}
    for n in ("cart.position", "arm.angle"):
        signals[n] = rows[:, [names.index(n)]]
    return Recording(TIME, signals, RecordingInfo("measured", scenario="a"))


@pytest.fixture
def lab(rig, moved, tmp_path):
    """A log in other units, signs and names, its map, and the rig's files beside it."""
    write_files(tmp_path)
    (tmp_path / "m.toml").write_text(MAP)
    columns = {
        "Time (ms)": 1e3 * moved.time + 7e4,
        "F [kN]": 1e-3 * moved["drive.force"][:, 0],
        "m": moved["hinge.torque"][:, 0],
        "x [mm]": -1e3 * moved["cart.position"][:, 0],
        "a [deg]": np.degrees(moved["arm.angle"][:, 0]),
    }
    rows = zip(*columns.values(), strict=True)
    text = "\n".join([";".join(columns), *(";".join(f"{v:.12g}" for v in row) for row in rows)])
    (tmp_path / "log.csv").write_text(text)
    return tmp_path


def test_a_log_by_its_map_is_the_recording_in_the_units_of_the_rig(lab, rig, moved):
    found = read_recording(lab / "log.csv", rig, ImportMap.load(lab / "m.toml"))
    for name, values in moved.signals.items():
        # twelve digits in the file, of numbers up to 1e3 mm
        assert found[name] == pytest.approx(values, abs=1e-9), name
    assert found.time == pytest.approx(moved.time, abs=1e-9)
    assert "load.force" not in found.signals


def test_an_imported_recording_is_the_same_as_the_log_by_its_map(lab, rig):
    words = ["import", str(lab / "log.csv"), "--map", str(lab / "m.toml")]
    words += ["--plant", str(lab / "two_link.toml"), "--out", str(lab / "rec.parquet")]
    assert main(words) == 0
    one = read_recording(lab / "log.csv", rig, ImportMap.load(lab / "m.toml"))
    two = read_recording(lab / "rec.parquet", rig)
    assert all(np.array_equal(one[n], two[n]) for n in one.signals)


def test_compare_reads_log_map_and_experiment_and_finds_the_rig_itself(lab, capsys):
    (lab / "e.toml").write_text('plant = "two_link.toml"\ncompare = ["cart.position"]\n')
    words = ["compare", str(lab / "log.csv"), "--map", str(lab / "m.toml")]
    words += ["--experiment", str(lab / "e.toml"), "--out", str(lab / "out"), "--json"]
    assert main(words) == 0
    (found,) = json.loads(capsys.readouterr().out)["recordings"]
    assert list(found["channels"]) == ["cart.position"]
    # both are one simulation; the file's digits are left
    assert found["channels"]["cart.position"]["rms"] < 1e-8


def test_a_gap_is_left_out_of_what_is_compared(lab, capsys):
    lines = (lab / "log.csv").read_text().splitlines()
    for k in range(1500, 1520):
        cells = lines[k].split(";")
        lines[k] = ";".join([*cells[:3], "", cells[4]])
    (lab / "log.csv").write_text("\n".join(lines))
    words = ["compare", str(lab / "log.csv"), "--map", str(lab / "m.toml")]
    words += ["--plant", str(lab / "two_link.toml"), "--out", str(lab / "out"), "--json"]
    assert main(words) == 0
    (found,) = json.loads(capsys.readouterr().out)["recordings"]
    assert found["channels"]["cart.position"]["rms_slow"] < 1e-7


def test_a_payload_is_a_point_mass_of_the_body(rig):
    """Against MuJoCo's own composition: the same ball, small, as a geom of the arm."""
    told = MjcfExperiment(payload={"body": "arm", "mass": "0.5 kg", "at": [0.0, 0.05, -0.3]})
    found = rig_of(told, rig).model
    spec = mujoco.MjSpec.from_string(MODEL)
    spec.body("arm").add_geom(pos=[0.0, 0.05, -0.3], size=[1e-4, 0, 0], mass=0.5)
    other = spec.compile()
    path = []
    for model in (found, other):
        model.body("cart").mass[0] = 3.1  # as the rig's file has it
        data = mujoco.MjData(model)
        data.qpos[1] = 0.7
        mujoco.mj_forward(model, data)
        path.append(data.qacc.copy())
    # what is left is the inertia of a ball of 0.1 mm
    assert path[0] == pytest.approx(path[1], rel=1e-6)


def test_parameters_mode_start_and_window_are_those_of_the_experiment(rig, moved):
    told = MjcfExperiment(
        drive=("cart.set",),
        parameters={"cart.mass": "3.3 kg", "rail.damping": 9},
        start={"state": "given", "joints": {"swing": {"position": "10 deg", "sd": 0.01}}},
        window={"start": 1.0, "stop": 3.0},
    )
    made = rig_of(told, rig)
    assert made.description.drive.mode is Mode.REFERENCE
    assert float(made.model.body("cart").mass[0]) == pytest.approx(3.3)
    assert float(made.model.dof_damping[0]) == pytest.approx(9.0)
    assert made.identity != rig.identity
    starts = [p.name for p in MjcfForward.of(made).parameters if p.per_recording]
    assert "start@swing:position" in starts
    sets = {**moved.signals, "cart.set": programme().drive["cart.set"]}
    told = told.model_copy(update={"start": type(told.start)()})
    ready, _, start = applied("a", Recording(TIME, sets, moved.info), told, rig)
    assert start == 1.0
    assert ready.time[-1] < 3.0
    assert np.isnan(ready["cart.position"][ready.time < 1.0]).all()
    assert np.isfinite(ready["cart.set"]).all()


def test_a_start_in_motion_is_read_from_the_first_rows(rig, moved):
    """A recording cut in the middle of a motion: settled misses it by its size, estimated does not."""
    late = moved.window(1.0, 4.0)
    error = {}
    for state in ("settled", "estimated"):
        _, made, _ = applied("a", late, MjcfExperiment(start={"state": state}), rig)
        forward = MjcfForward.of(made)
        rows = forward.simulate(Excitation.of(late, forward.drive), {})
        at = [c.name for c in forward.channels].index("cart.position")
        error[state] = float(np.max(np.abs(rows[:, at] - late["cart.position"][:, 0])))
    assert error["settled"] > 0.05
    # a first difference behind a low-pass of 60 Hz: per cents of the speed, for three seconds
    assert error["estimated"] < 0.1 * error["settled"]


def test_recordings_of_one_diagnosis_are_of_one_rig(rig, moved):
    told = MjcfExperiment(recordings={"b": {"parameters": {"cart.mass": 4.0}}})
    one, other = (applied(name, moved, told, rig)[1] for name in "ab")
    assert one.identity != other.identity
    with pytest.raises(VesTwinError, match="one rig in all recordings"):
        MjcfMachine(rig).prepare(Material((Named("a", moved), Named("b", moved))), told)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("drive = ['drive.forc']", "did you mean 'drive.force'"),
        ("drive = ['drive.force']", "drive.force, hinge.torque (control)"),
        ("compare = ['cart.positon']", "did you mean 'cart.position'"),
        ("scenario = 'identify_fast'", "belongs to an experiment with VES II"),
        ("payload = '2 kg'", 'expected { body = "...", mass = "... kg" }'),
        ("payload = { body = 'arn', mass = '2 kg' }", "did you mean 'arm'"),
        ("parameters = { 'cart.mas' = 3 }", "did you mean 'mass'"),
        ("parameters = { 'cat.mass' = 3 }", "did you mean 'cart'"),
        ("[start]\nstate = 'given'", "goes with state = 'given'"),
        ("[start]\nstate = 'setled'", "did you mean 'settled'"),
        ("[start]\nstate='given'\n[start.joints.rial]\nposition = 0", "did you mean 'rail'"),
        ("[window]\nstart = 50", "window of log.csv"),
        ("[recordings.lag]\nnoise = 'declared'", "did you mean 'log'"),
        ("noise = 'still.csv'", "still.csv"),
    ],
)
def test_an_experiment_that_cannot_be_is_one_line(lab, capsys, text, words):
    (lab / "e.toml").write_text(text)
    options = ["--map", str(lab / "m.toml"), "--plant", str(lab / "two_link.toml")]
    options += ["--experiment", str(lab / "e.toml"), "--out", str(lab / "out")]
    assert main(["diagnose", str(lab / "log.csv"), *options]) == 2
    error = capsys.readouterr().err.strip()
    assert words in error
    assert "\n" not in error
    assert not (lab / "out").exists()


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('to = "cart.position"', 'to = "cart.positon"', "did you mean 'cart.position'"),
        ('unit = "N*m"', 'unit = "kg"', "a unit that converts to N*m"),
        ('to = "drive.force"', 'to = "leg.length.1"', "unknown signal column 'leg.length.1'"),
    ],
)
def test_a_map_that_does_not_fit_the_rig_is_one_line(lab, capsys, old, new, words):
    assert old in MAP
    (lab / "m.toml").write_text(MAP.replace(old, new))
    options = ["--map", str(lab / "m.toml"), "--plant", str(lab / "two_link.toml")]
    assert main(["compare", str(lab / "log.csv"), *options, "--out", str(lab / "out")]) == 2
    error = capsys.readouterr().err.strip()
    assert words in error
    assert "\n" not in error


def test_mm_taken_for_m_is_suspected_by_the_typical_travel(lab, capsys):
    (lab / "m.toml").write_text(MAP.replace("sign = -1", 'sign = -1\nunit = "m"'))
    words = ["import", str(lab / "log.csv"), "--map", str(lab / "m.toml"), "--json"]
    words += ["--plant", str(lab / "two_link.toml"), "--out", str(lab / "rec.parquet")]
    assert main(words) == 0
    suspected = json.loads(capsys.readouterr().out)["suspected"]
    assert any("cart.position" in one and "mm taken for m" in one for one in suspected)
