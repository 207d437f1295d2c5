"""Experiment files: what a measured recording does not say of itself."""

from dataclasses import replace

import numpy as np
import pytest

import ves_twin as vt
from ves_twin.core.errors import VesTwinError
from ves_twin.core.recording.recording import RecordingInfo
from ves_twin.scenario.experiment import Experiment


def recording(*names: str) -> vt.Recording:
    return vt.Recording(
        np.arange(3.0), {n: np.zeros((3, 6)) for n in names}, RecordingInfo("measured")
    )


def load(tmp_path, text):
    path = tmp_path / "lab.toml"
    path.write_text(text)
    return Experiment.load(path)


def test_an_experiment_says_what_a_scenario_says(tmp_path):
    told = load(
        tmp_path,
        """
        drive = ["leg.command"]
        compare = ["leg.length"]
        scenario = "identify_slow"
        settings = { "legs.gain" = 10.0 }
        payload = "500 g"
        [start]
        state = "given"
        pose = [0.0, 0.0, "10 mm", 0.0, 0.0, 0.0]
        joints = [0.0, "45 deg", 0.0]
        [window]
        start = "1 s"
        stop = 5
        """,
    )
    scenario = told.scenario_of(recording("leg.command"))
    assert scenario.legs.gain == 10.0
    assert scenario.platform.start[2] == pytest.approx(0.01)
    assert scenario.arm.start[1] == pytest.approx(np.pi / 4)
    assert told.payload == pytest.approx(0.5)
    assert (told.window.start, told.window.stop) == (1.0, 5.0)


def test_without_a_word_the_drive_is_what_was_recorded():
    assert Experiment().drive_of(recording("leg.command", "leg.length")) == ("leg.command",)
    found = Experiment().drive_of(recording("platform.command", "gravity.estimate"))
    assert found == ("platform.command", "gravity.estimate")


def test_a_measured_recording_without_a_scenario_asks_for_an_experiment():
    with pytest.raises(VesTwinError, match="an --experiment file that names one"):
        Experiment().scenario_of(recording("leg.command"))


def test_metadata_of_a_foreign_scenario_get_one_line():
    bare = recording("leg.command")
    odd = replace(bare, info=replace(bare.info, settings='{"name": "x", "legs": {"gian": 1}}'))
    with pytest.raises(VesTwinError, match=r"metadata of the recording"):
        Experiment().scenario_of(odd)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ('drive = ["leg.comand"]', "did you mean 'leg.command'"),
        ('drive = ["arm.command"]', r"leg\.command or platform\.command"),
        ('compare = ["truth.pose"]', "signal to compare"),
        ("drvie = []", "did you mean 'drive'"),
        ('[start]\nstate = "given"', "needs start.pose"),
        ("[start]\npose = [0, 0, 0, 0, 0, 0]", "are for state 'given'"),
        ("[window]\nstart = 5\nstop = 2", "not after start"),
        ('payload = "1 m"', "kg"),
        ('settings = { "legs.gain" = 10 }', "none is named"),
        ("x = [", "valid TOML"),
    ],
)
def test_a_bad_experiment_gets_one_line(tmp_path, text, says):
    with pytest.raises(VesTwinError, match=says) as caught:
        load(tmp_path, text)
    assert "\n" not in str(caught.value)
