"""trend on a carriage in MuJoCo: a folder of dated logs to an answer, and one line where it cannot."""

from __future__ import annotations

import json

import numpy as np
import pytest
from slide import machine, write_day, write_files

from ves_twin.cli.main import main
from ves_twin.cli.trend import _named, recordings_in
from ves_twin.core.errors import VesTwinError
from ves_twin.diagnosis.trend.result import DaySize

DATES = ("2026-03-02", "2026-03-04", "2026-03-09", "2026-03-11")


@pytest.fixture(scope="module")
def rig(tmp_path_factory):
    return write_files(tmp_path_factory.mktemp("slide"))


def logs(folder, friction, other=(), seed=3):
    rng = np.random.default_rng(seed)
    one, two = machine(rng), machine(rng)
    folder.mkdir()
    for k, (date, level) in enumerate(zip(DATES, friction, strict=True)):
        write_day(folder / f"slide_{date}.csv", rng, two if k in other else one, level)
    (folder / "notes.md").write_text("not a recording")
    return str(folder)


def asked(capsys, folder, rig, out, *more):
    words = ["trend", folder, "--plant", str(rig), "--out", str(out), "--json", *more]
    assert main(words) == 0
    return json.loads(capsys.readouterr().out)


@pytest.mark.slow
def test_a_hidden_onset_is_named_and_dated_from_a_folder(tmp_path, capsys, rig):
    # seed 3 drew a carriage whose damping is 3.2 sd off: at the limit of what one rig may be
    folder = logs(tmp_path / "logs", [0.02, 0.02, 0.03, 0.03], seed=4)
    said = asked(capsys, folder, rig, tmp_path / "out")
    assert said == json.loads((tmp_path / "out" / "trend.json").read_text())
    assert said["answer"] == "step"
    assert (said["cause"]["effect"], said["cause"]["target"]) == ("coulomb_friction", "rail")
    assert said["change"]["onset_date"] == {
        "value": "2026-03-09",
        "low": "2026-03-04",
        "high": "2026-03-09",
    }
    for when, truth in (("before", 0.02), ("after", 0.03)):
        size = said["change"][when]
        # the interval is of 90 %; twice its half-width is 3.3 sigma
        assert abs(size["value"] - truth) < size["high"] - size["low"]
    assert said["unit"] == "day"
    assert said["days"] == [0.0, 2.0, 7.0, 9.0]
    page = (tmp_path / "out" / "report.html").read_text()
    assert "Coulomb friction at rail changed between 2026-03-04 and 2026-03-09" in page
    assert page.count("<svg") == 1


@pytest.mark.slow
def test_two_carriages_in_one_folder_are_told_and_one_in_order_is_left_in_peace(
    tmp_path, capsys, rig
):
    mixed = logs(tmp_path / "mixed", [0.0] * 4, other=(1, 2))
    said = asked(capsys, mixed, rig, tmp_path / "out")
    assert said["answer"] == "mixed"
    assert said["one_rig"]["groups"] == [[0, 3], [1, 2]]
    alone = logs(tmp_path / "alone", [0.0] * 4)
    # numbered: what the dates are does not matter to nothing
    said = asked(capsys, alone, rig, tmp_path / "out", "--numbered")
    assert (said["answer"], said["unit"], said["dates"][0]) == (
        "nothing",
        "recording",
        "recording 1",
    )


@pytest.mark.parametrize(
    ("more", "words"),
    [
        (["--plant", "ves2"], "`ves-twin import` makes one of a log"),
        ([], "`ves-twin import` makes one of a log"),
        (["--plant", "{rig}", "--cause", "coulomb_fricton@rail"], "did you mean 'coulomb_friction"),
        (["--plant", "{rig}", "--false-alarm", "2"], "0.0001 to 0.2"),
        (["--plant", "{rig}", "--false-alram", "2"], "did you mean '--false-alarm'"),
        (["{undated}", "--plant", "{rig}"], "date of undated.csv"),
    ],
)
def test_what_cannot_be_is_one_line(tmp_path, capsys, rig, more, words):
    folder = logs(tmp_path / "logs", [0.0] * 4)
    undated = tmp_path / "undated.csv"
    undated.write_text((tmp_path / "logs" / f"slide_{DATES[0]}.csv").read_text())
    names = {"{rig}": str(rig), "{undated}": str(undated)}
    options = [names.get(word, word) for word in more]
    assert main(["trend", folder, *options, "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err.strip()
    assert words in error
    assert "\n" not in error
    assert not (tmp_path / "out" / "trend.json").exists()


def test_an_empty_folder_and_too_few_days_are_one_line(tmp_path, capsys, rig):
    (tmp_path / "none").mkdir()
    with pytest.raises(VesTwinError, match="holds no recording"):
        recordings_in([str(tmp_path / "none")])
    folder = logs(tmp_path / "logs", [0.0] * 4)
    two = sorted(recordings_in([folder]))[:2]
    assert main(["trend", *two, "--plant", str(rig), "--out", str(tmp_path / "out")]) == 2
    assert "at least 3" in capsys.readouterr().err


def test_recordings_that_are_called_by_their_date_are_listed_by_it_once():
    def size(name, date):
        return DaySize(name, date, 0.0, 1.0, 0.9, 1.1, 0.05, 0.0, True)

    dated = [size(date, date) for date in DATES]
    assert _named(dated) == list(DATES)
    assert _named([size("axis_1", DATES[0]), dated[1]])[0] == f"{'axis_1':<10}  {DATES[0]}"
