"""ves-twin compare: a folder of a run needs no more words; exit codes; bad input in one line."""

import json

import numpy as np
import pytest

import ves_twin as vt
from ves_twin.cli.main import main
from ves_twin.core.recording.files import save_recording

pytestmark = pytest.mark.usefixtures("standing")

CHANGES = {
    "run.duration": 4.0,
    "plant": "ves2",
    "arm.moves": [{"start": 0.5, "duration": 2.0, "to": [0.8, 0.4, 0.3]}],
}


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("run")
    recording = vt.simulate(vt.Scenario.load("identify_fast", CHANGES), seed=2)
    save_recording(recording, folder / "recording.parquet")
    return folder


@pytest.fixture
def bare(run, tmp_path):
    """The run as a laboratory would have it: no scenario in it."""
    recording = vt.load_recording(run)
    info = type(recording.info)("measured")
    path = tmp_path / "lab.parquet"
    save_recording(vt.Recording(recording.time, recording.signals, info), path)
    return path


def test_a_folder_of_a_run_needs_no_more_words(run, tmp_path, capsys):
    assert main(["compare", str(run), "--out", str(tmp_path / "out"), "--json"]) == 0
    content = json.loads(capsys.readouterr().out)
    assert content["recordings"][0]["plant"] == "ves2"
    assert content["in_tolerance"] is None
    assert content["recordings"][0]["beyond_noise"] == []
    written = json.loads((tmp_path / "out" / "compare.json").read_text())
    assert written == content
    assert (tmp_path / "out" / "report.html").stat().st_size < 5e6


@pytest.mark.slow
@pytest.mark.usefixtures("unpictured")
def test_out_of_tolerance_exits_4_and_within_it_0(run, tmp_path, capsys):
    limits = tmp_path / "limits.toml"
    words = ["compare", str(run), "--tolerance", str(limits), "--out", str(tmp_path / "out")]
    limits.write_text('schema = 1\n[rms]\nsensor.wrench = "0.01 N"\n')
    assert main(words) == 4
    assert "Out of tolerance: sensor.wrench.1 rms" in capsys.readouterr().out
    limits.write_text('schema = 1\n[rms]\nsensor.wrench = "2 N"\n[peak]\nleg.length = "1 mm"\n')
    assert main(words) == 0
    assert "every one is kept" in capsys.readouterr().out


@pytest.mark.slow
@pytest.mark.usefixtures("unpictured")
def test_a_measured_recording_is_told_by_an_experiment(bare, tmp_path, capsys):
    told = tmp_path / "lab.toml"
    told.write_text(
        'scenario = "identify_fast"\nplant = "ves2"\ncompare = ["leg.length"]\n'
        '[start]\nstate = "given"\npose = [0, 0, 0, 0, 0, 0]\njoints = [0, "45 deg", 0]\n'
    )
    words = ["compare", str(bare), "--experiment", str(told), "--out", str(tmp_path / "out")]
    assert main([*words, "--json"]) == 0
    (found,) = json.loads(capsys.readouterr().out)["recordings"]
    assert len(found["channels"]) == 6
    assert found["beyond_noise"] == []


def test_bad_input_gets_one_line_and_writes_nothing(run, bare, tmp_path, capsys):
    short = tmp_path / "short.parquet"
    recording = vt.load_recording(run)
    save_recording(recording.window(0.0, 0.2), short)
    still = tmp_path / "still.parquet"
    half = {name: values[::2] for name, values in recording.signals.items()}
    save_recording(vt.Recording(np.array(recording.time[::2]), half, recording.info), still)
    cases = [
        ([str(bare)], "an --experiment file"),
        (["no/such.parquet"], "does not exist"),
        ([str(short)], "at least 64"),
        ([str(run), "--plant", "vse2"], "did you mean 've"),
        ([str(run), "--tolerence", "x"], "did you mean '--tolerance'"),
        ([str(run), "--tolerance", "no.toml"], "no.toml"),
        ([str(run), "--standstill", str(still)], "rate of the standstill recording"),
        ([str(run), "--against", str(still)], "rate of --against"),
    ]
    for words, says in cases:
        assert main(["compare", *words, "--out", str(tmp_path / "out")]) == 2, words
        out, err = capsys.readouterr()
        assert out == ""
        assert says in err, words
        assert err.count("\n") == 1, words
    assert not (tmp_path / "out").exists()
