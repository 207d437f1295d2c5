"""The diagnose and plan commands: bad input is one line; what is found is written as files."""

import json
from pathlib import Path

import numpy as np
import pytest
from pendulum import FRICTION, PLANT

import ves_twin as vt
from ves_twin.cli.main import main
from ves_twin.core.recording.files import load_recording, save_recording
from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.diagnosis.diagnose import diagnose
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.diagnosis.settings import Settings
from ves_twin.machines.diagnose import Diagnosis
from ves_twin.machines.ves2.forward import DRIVE
from ves_twin.machines.ves2.ves2_machine import Ves2Machine

SHORT = {"run.duration": 2.0, "run.settle": 0.3}


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    path = tmp_path_factory.mktemp("lab") / "run.parquet"
    save_recording(vt.simulate(vt.Scenario.load("identify_fast", SHORT)), path)
    return str(path)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["no_such.parquet"], "does not exist"),
        (["{recording}", "--plant", "vse2"], "did you mean 'ves2'"),
        (["{recording}", "--exclude", "valve_nul"], "did you mean 'valve_null"),
        (["{recording}", "--held-out", "no_such.parquet"], "does not exist"),
    ],
)
def test_bad_input_is_one_line_and_exit_2(capsys, tmp_path, recording, options, words):
    options = [recording if o == "{recording}" else o for o in options]
    assert main(["diagnose", *options, "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err.strip()
    assert words in error
    assert "\n" not in error


@pytest.fixture
def found(monkeypatch, recording):
    """A diagnosis whose verdict was made of a pendulum, so that it takes seconds."""
    fed = Excitation("pendulum", 0.002 * np.arange(2000), {"joint.torque": TORQUE})
    rows = PLANT.simulate(fed, {FRICTION: 0.1})
    rows += np.random.default_rng(0).normal(size=rows.shape) * [0.001, 0.01]
    signals = {"joint.torque": TORQUE, "joint.angle": rows[:, :1], "joint.rate": rows[:, 1:]}
    data = Recording(fed.time, signals, RecordingInfo("measured"))
    others = [h.effect for h in PLANT.hypotheses if h.effect not in CONSIDERED]
    quick = Settings(nulls=20, simulated_nulls=False)
    verdict = diagnose(PLANT, [data], exclude=others, settings=quick)
    setpoints = Excitation.of(load_recording(Path(recording)), DRIVE, "next")
    plant = vt.Plant.load("ves2_fast").extended(vt.effects.CoulombFriction("leg.3", level=60.0))
    scenario = vt.Scenario.load("identify_fast")
    machine, why = Ves2Machine(plant, scenario), "there were no held-out recordings"
    result = Diagnosis(verdict, machine, machine, why, setpoints)
    monkeypatch.setattr("ves_twin.machines.diagnose.diagnose", lambda *a, **k: result)
    return verdict


CONSIDERED = ("coulomb_friction", "viscous_friction")
"""Files are written of any verdict: two causes are found in a fifth of the time of ten."""

TORQUE = np.sin(2 * np.pi * 0.7 * 0.002 * np.arange(2000))[:, None]


def test_a_diagnosis_writes_what_the_contract_names(capsys, tmp_path, recording, found):
    out = tmp_path / "out"
    assert main(["diagnose", recording, "--out", str(out), "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert said == json.loads((out / "verdict.json").read_text())
    assert set(said) >= {
        *("schema", "verdict", "basis", "causes", "residuals", "gain", "leftover"),
        *("smallest_findable", "next_experiment", "rivals"),
    }
    assert {path.name for path in out.iterdir()} == {
        *("verdict.json", "report.html", "diagnosis.rrd", "plant.candidate.toml"),
        *("next_experiment.csv", "next_experiment.toml"),
    }
    page = (out / "report.html").read_text()
    assert "Coulomb friction at joint" in page
    assert "plant.candidate.toml: there were no held-out recordings" in page


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--channels", "leg.lenght"], "did you mean 'leg.length"),
        (["--scenario", "identify_fats"], "did you mean 'identify_fast'"),
        (["--seconds", "0.01"], "seconds: got 0.01"),
    ],
)
def test_a_plan_refuses_bad_input_in_one_line(capsys, options, words):
    assert main(["plan", *options]) == 2
    error = capsys.readouterr().err.strip().splitlines()[-1]
    assert words in error


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('[recordings.rnu]\npayload = "1 kg"\n', "did you mean 'run"),
        ("[window]\nstart = 50\n", "window of run.parquet"),
        ('scenario = "identify_fats"\n', "did you mean 'identify_fast'"),
        ('noise = "no_such.parquet"\n', "does not exist"),
    ],
)
def test_an_experiment_that_cannot_be_is_one_line(capsys, tmp_path, recording, text, words):
    (tmp_path / "lab.toml").write_text(text)
    options = ["--experiment", str(tmp_path / "lab.toml"), "--out", str(tmp_path / "out")]
    assert main(["diagnose", recording, *options]) == 2
    error = capsys.readouterr().err.strip()
    assert words in error
    assert "\n" not in error
    assert not (tmp_path / "out").exists()


def test_one_file_cannot_be_measured_and_held_out(capsys, tmp_path, recording):
    (tmp_path / "lab.toml").write_text('payload = "1 kg"\n')
    options = ["--experiment", str(tmp_path / "lab.toml"), "--out", str(tmp_path / "out")]
    assert main(["diagnose", recording, "--held-out", recording, *options]) == 2
    assert "two of one name" in capsys.readouterr().err


def test_a_copy_of_a_fitted_file_cannot_be_held_out(capsys, tmp_path, recording):
    copy = tmp_path / "copy.parquet"
    copy.write_bytes(Path(recording).read_bytes())
    options = ["--out", str(tmp_path / "out")]
    assert main(["diagnose", recording, "--held-out", str(copy), *options]) == 2
    error = capsys.readouterr().err.strip().splitlines()[-1]
    assert "held-out recording: got 'copy" in error
    assert "which is fitted and has the same rows" in error
