"""`run --video`: a film that moves as the run does, and one line where it cannot be."""

import json
import sys

import numpy as np
import pytest
from PIL import Image

import ves_twin as vt
from ves_twin.cli.main import main
from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.envs.film import BESIDE, FRAMES, LONGEST, write_film
from ves_twin.envs.film_curves import FADED, FilmCurves
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
        assert film.size == (WIDTH + BESIDE, HEIGHT)
    seen = list(frames(path))
    assert sum(seconds for seconds, _ in seen) == pytest.approx(DURATION, abs=FRAMES[".gif"])
    first, last = (pixels[60:, :WIDTH] for _, pixels in (seen[0], seen[-1]))  # below the time
    assert first.std() > 10.0  # an empty scene is one colour
    assert np.mean(np.any(np.abs(first - last) > 16, axis=2)) > 0.01  # the arm has turned
    assert not list(tmp_path.glob(".*partial"))


def test_other_endings_and_procedures_are_one_line_before_anything_runs(tmp_path, capsys):
    folder = str(tmp_path / "run")
    assert main([*WORDS, "--out", folder, "--video", "run.avi"]) == 2
    assert "FILE.mp4 or FILE.gif" in capsys.readouterr().err
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


def still(count=3, moved=1.0):
    time = 0.1 * np.arange(count)
    pose = np.zeros((count, 6))
    pose[:, 1] = moved * time
    signals = {"platform.pose": pose, "reference.pose": 0.5 * pose}
    return Recording(time, signals, RecordingInfo("simulated"))


def test_an_mp4_holds_every_picture_at_its_time(can_draw, tmp_path):
    import av

    path = tmp_path / "a.mp4"
    count = write_film(still(), path)
    with av.open(str(path)) as film:
        decoded = list(film.decode(video=0))
    assert (decoded[0].width, decoded[0].height) == (WIDTH + BESIDE, HEIGHT)
    assert len(decoded) == count == 6
    assert [frame.time for frame in decoded] == pytest.approx(FRAMES[".mp4"] * np.arange(count))


def test_an_mp4_without_its_extra_is_one_line_that_names_it(monkeypatch, tmp_path, capsys):
    monkeypatch.setitem(sys.modules, "av", None)
    folder = str(tmp_path / "run")
    assert main([*WORDS, "--out", folder, "--video", str(tmp_path / "a.mp4")]) == 2
    error = capsys.readouterr().err
    assert "pip install 'ves_twin[video]'" in error
    assert error.count("\n") == 1
    assert not (tmp_path / "run").exists()


def test_curves_are_bright_up_to_the_time_shown_and_faded_after_it():
    curves = FilmCurves.of(still(200), BESIDE, HEIGHT)
    shown = curves.at(10.0).astype(float)
    here = round(curves.left + 10.0 * curves.pace)
    before, after = (slice(None), slice(0, here)), (slice(None), slice(here + 3, None))
    assert np.array_equal(shown[before], curves.bright[before])
    ink, faded = (255.0 - pixels[after][curves.inside] for pixels in (curves.bright, shown))
    assert ink.max() > 100.0
    assert faded == pytest.approx(FADED * ink, abs=1.0)
    assert np.array_equal(shown[~curves.inside], curves.bright[~curves.inside])


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
            write_film(recording, tmp_path / "a.gif")


def test_a_measured_recording_is_drawn_where_its_numbers_are_finite(can_draw, tmp_path):
    q = np.zeros((3, 3))
    q[1] = np.nan
    signals = {"arm.q": q}
    recording = Recording(np.array([0.0, 0.1, 0.2]), signals, RecordingInfo("measured"))
    assert write_film(recording, tmp_path / "a.gif") == 3
    assert vt.Plant.load("ves2")  # drawn with the default rig, since none is named
