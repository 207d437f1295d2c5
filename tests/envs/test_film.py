"""`run --video`: a GIF of the run that moves as the run does, and one line where it cannot be."""

import json

import numpy as np
import pytest
from PIL import Image

import ves_twin as vt
from ves_twin.cli.main import main
from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.envs.film import FRAME, LONGEST, write_gif
from ves_twin.envs.picture import HEIGHT, WIDTH, NoPictureError, check_off_screen

DURATION = 1.2
WORDS = ["run", "beam_horizontal_truth", "--plant", "ves2_fast", "--no-rrd"]
WORDS += ["--set", f"run.duration={DURATION}"]


@pytest.fixture
def can_draw():
    try:
        check_off_screen()
    except NoPictureError as error:
        pytest.skip(str(error))


def frames(path):
    # equal pictures in a row are kept as one that lasts longer
    with Image.open(path) as film:
        for k in range(film.n_frames):
            film.seek(k)
            yield film.info["duration"] / 1000.0, np.asarray(film.convert("RGB")).astype(int)


@pytest.mark.slow
def test_a_run_is_drawn_in_real_time(can_draw, tmp_path, capsys):
    path = tmp_path / "run.gif"
    assert main([*WORDS, "--out", str(tmp_path / "run"), "--video", str(path)]) == 0
    capsys.readouterr()
    with Image.open(path) as film:
        assert film.size == (WIDTH, HEIGHT)
    seen = list(frames(path))
    assert sum(seconds for seconds, _ in seen) == pytest.approx(DURATION, abs=FRAME)
    first, last = seen[0][1], seen[-1][1]
    assert first.std() > 10.0  # an empty scene is one colour
    assert np.mean(np.any(np.abs(first - last) > 16, axis=2)) > 0.01  # the arm has turned
    assert not list(tmp_path.glob(".*partial"))


def test_other_endings_and_procedures_are_one_line_before_anything_runs(tmp_path, capsys):
    folder = str(tmp_path / "run")
    assert main([*WORDS, "--out", folder, "--video", "run.mp4"]) == 2
    assert "FILE.gif" in capsys.readouterr().err
    assert main(["run", "leg_response", "--out", folder, "--video", "a.gif"]) == 2
    assert "not a procedure" in capsys.readouterr().err
    assert not (tmp_path / "run").exists()


def test_what_could_not_be_drawn_is_refused_before_anything_runs(tmp_path, capsys):
    folder = str(tmp_path / "run")
    long = ["--set", f"run.duration={LONGEST + 1}", "--video", str(tmp_path / "a.gif")]
    for words, says in (
        (long, "at most 120 s"),
        (["--video", str(tmp_path / "none" / "a.gif")], "cannot write"),
        (["--video", f"{_folder(tmp_path / 'is.gif')}"], "it is a folder"),
    ):
        assert main([*WORDS, "--out", folder, *words]) == 2
        error = capsys.readouterr().err
        assert says in error
        assert error.count("\n") == 1
    assert not (tmp_path / "run").exists()


def _folder(path):
    path.mkdir()
    return path


def test_a_run_without_rows_is_told_and_has_no_film(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr("ves_twin.envs.film.check_off_screen", lambda: None)
    path = tmp_path / "a.gif"
    weak = ["--set", "parameters.sensor.range=[500.0,500.0,500.0,500.0,500.0,500.0]"]
    words = ["run", "position_sine", "--no-rrd", "--set", "run.settle=0.1", *weak]
    assert main([*words, "--out", str(tmp_path / "run"), "--video", str(path), "--json"]) == 3
    out, err = capsys.readouterr()
    assert json.loads(out)["outcome"] == "wrench_range"
    assert "ended before its first row" in err
    assert not path.exists()


def test_without_opengl_nothing_runs(monkeypatch, tmp_path, capsys):
    monkeypatch.setenv("MUJOCO_GL", "disabled")
    monkeypatch.setattr("ves_twin.envs.picture._gl_context", refuse)
    words = [*WORDS, "--out", str(tmp_path / "run"), "--video", str(tmp_path / "a.gif")]
    assert main(words) == 2
    error = capsys.readouterr().err
    assert "no OpenGL" in error
    assert error.count("\n") == 1
    assert not list(tmp_path.iterdir())


def refuse():
    raise NoPictureError("no OpenGL that draws off screen")


def test_too_long_and_empty_recordings_are_refused(can_draw, tmp_path):
    for time in (np.array([0.0, LONGEST + 1.0]), np.zeros(0)):
        recording = Recording(time, {}, RecordingInfo("simulated"))
        with pytest.raises(InvalidInputError, match="to draw"):
            write_gif(recording, tmp_path / "a.gif")


def test_a_measured_recording_is_drawn_where_its_numbers_are_finite(can_draw, tmp_path):
    q = np.zeros((3, 3))
    q[1] = np.nan
    signals = {"arm.q": q}
    recording = Recording(np.array([0.0, 0.1, 0.2]), signals, RecordingInfo("measured"))
    assert write_gif(recording, tmp_path / "a.gif") == 3
    assert vt.Plant.load("ves2")  # drawn with the default rig, since none is named
