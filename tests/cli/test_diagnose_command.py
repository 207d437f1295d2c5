"""The diagnose command: bad input is one line, before anything is computed."""

import pytest

import ves_twin as vt
from ves_twin.cli.main import main
from ves_twin.recording.files import save_recording

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
