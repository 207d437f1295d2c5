"""The next experiment can be carried out: set-points of a file, a scenario that plays them, a recording."""

import numpy as np
import pytest

import ves_twin as vt
from ves_twin.cli.main import main
from ves_twin.core.errors import FileAccessError, VesTwinError
from ves_twin.core.recording.files import load_recording, save_recording
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.machines.ves2.forward import DRIVE
from ves_twin.machines.ves2.next_scenario import SCENARIO, SETPOINTS, write_next_experiment
from ves_twin.scenario.setpoint_file import read_setpoints
from ves_twin.simulator.replay import replay_scenario

CHANGES = {
    "run.duration": 2.5,
    "run.settle": 0.3,
    "run.noise": False,
    "arm.start": ["10 deg", "50 deg", "-20 deg"],
    "arm.moves": [{"start": 0.4, "duration": 1.2, "to": ["60 deg", "80 deg", "-60 deg"]}],
}

ROUND_OFF = 2e-11
"""Twelve digits of an angle or of a length about one."""


@pytest.fixture(scope="module")
def plant():
    return vt.Plant.load("ves2_pressure_fast")


@pytest.fixture(scope="module")
def first(plant):
    return vt.simulate(vt.Scenario.load("identify_fast", CHANGES), plant=plant)


@pytest.fixture(scope="module")
def folder(plant, first, tmp_path_factory):
    out = tmp_path_factory.mktemp("next")
    programme = Excitation.of(first, DRIVE, "quick motion")
    write_next_experiment(programme, replay_scenario(first), plant, out)
    return out


def test_the_written_scenario_gives_the_set_points_of_the_file_again(folder, first, plant):
    scenario = vt.Scenario.load(str(folder / SCENARIO), {"run.settle": 0.3, "run.noise": False})
    assert scenario.plant == "ves2_pressure_fast"
    assert scenario.legs == vt.Scenario.load("identify_fast").legs
    again = vt.simulate(scenario)
    assert again.info.outcome == "completed"
    assert len(again) == len(first)
    for name in ("leg.command", "arm.command"):
        np.testing.assert_allclose(again[name], first[name], rtol=0, atol=ROUND_OFF)
    # what the rig answers is the same, too: the start, the sensor's zero and the loops are
    np.testing.assert_allclose(again["leg.length"], first["leg.length"], rtol=0, atol=1e-9)
    np.testing.assert_allclose(again["sensor.wrench"], first["sensor.wrench"], rtol=0, atol=1e-5)


def test_the_command_line_runs_it_from_anywhere(folder, first, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    options = ["--set", "run.settle=0.3", "--no-rrd", "--out", str(tmp_path / "run")]
    assert main(["run", str(folder / SCENARIO), *options]) == 0
    assert "Which of the causes" in capsys.readouterr().out
    recording = load_recording(tmp_path / "run")
    np.testing.assert_allclose(
        recording["arm.command"], first["arm.command"], rtol=0, atol=ROUND_OFF
    )
    # and its recording is fit for a diagnosis: it can be replayed by the plant
    replayed = replay_scenario(recording)
    assert replayed.platform.motion is None


def test_another_rate_is_followed_straight_between_the_rows(folder, first):
    changes = {"run.settle": 0.3, "run.noise": False, "platform.rate": 40.0}
    slow = vt.simulate(vt.Scenario.load(str(folder / SCENARIO), changes))
    there = np.interp(slow.time, first.time, first["leg.command"][:, 0])
    assert np.abs(slow["leg.command"][:, 0] - there).max() < 1e-5


def test_a_recording_is_a_file_of_set_points_itself(first, tmp_path):
    save_recording(first, tmp_path / "r.parquet")
    given = read_setpoints(str(tmp_path / "r.parquet"))
    np.testing.assert_array_equal(given.legs, first["leg.command"])
    np.testing.assert_array_equal(given.arm, first["arm.command"])


def test_a_folder_that_cannot_be_written_gives_one_line(first, plant, tmp_path):
    programme = Excitation.of(first, DRIVE, "quick motion")
    with pytest.raises(FileAccessError, match="cannot write"):
        write_next_experiment(programme, replay_scenario(first), plant, tmp_path / "none")


def test_set_points_of_the_arm_and_moves_of_the_arm_are_refused_together(folder):
    moves = [{"start": 0.0, "duration": 1.0, "to": [0.0, 0.0, 0.0]}]
    scenario = vt.Scenario.load(str(folder / SCENARIO), {"arm.moves": moves})
    with pytest.raises(VesTwinError, match=rf"{SETPOINTS}.*no arm\.moves"):
        vt.simulate(scenario)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"platform.start": [0.1, 0.0, 0.0, 0.0, 0.0, 0.0]}, "pose of the first row"),
        ({"arm.start": [0.0, 0.0, 0.0]}, "first row.*arm.start"),
        ({"platform.motion.file": "none.csv"}, "none.csv' does not exist"),
    ],
)
def test_a_file_that_does_not_begin_where_the_rig_stands_is_refused(folder, changes, words):
    scenario = vt.Scenario.load(str(folder / SCENARIO), changes)
    with pytest.raises(VesTwinError, match=words):
        vt.simulate(scenario)
