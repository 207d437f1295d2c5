"""Folders whose names are odd: none at all, or letters that the locale does not know."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from ves_twin.cli.main import _give_matplotlib_a_folder, main

ASCII = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
"""A locale whose file names are ASCII: Python hands other bytes on as they are."""

ONE_BY_ONE = """
import sys
from ves_twin.cli.main import main
words = []
for word in sys.argv[1:]:
    words.append(word)
    if word == ";":
        assert main(words[:-1]) == 0, words
        words = []
"""

SHORT = ["--set", "run.duration=1.5", "--set", "run.settle=0.2", "--set", "plant=ves2_fast"]


@pytest.mark.parametrize(
    "words",
    [
        ["run", "position_sine", *SHORT, "--out", ""],
        ["run", "position_sine", *SHORT, "--out="],
        ["diagnose", "x.parquet", "--out", " "],
        ["compare", "", "--out", "x"],
        ["run", "position_sine", "--plant", ""],
        ["blind", "make", "--out", ""],
        [""],
    ],
)
def test_an_empty_argument_is_refused_and_nothing_is_touched(words, tmp_path, monkeypatch, capsys):
    """It once meant the folder in which the user stood, whose summary.json was removed."""
    monkeypatch.chdir(tmp_path)
    for name in ("summary.json", "run.rrd", "plant.toml"):
        (tmp_path / name).write_text("mine")
    assert main(words) == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert {p.name: p.read_text() for p in tmp_path.iterdir()} == {
        name: "mine" for name in ("summary.json", "run.rrd", "plant.toml")
    }


@pytest.mark.slow
def test_letters_that_the_locale_lacks_harm_no_command(tmp_path):
    commands = [
        ["run", "position_sine", *SHORT, "--out", "versé"],
        ["compare", "versé", "--against", "versé", "--out", "versé/c"],
        ["export", "versé", "--out", "versé/é.csv"],
        ["export", "versé", "--out", "versé/é.parquet"],
        ["sweep", "position_sine", *SHORT, "--vary", "seed=1", "--workers=1", "--out", "versé/s"],
    ]
    together = [word for words in commands for word in (*words, ";")]
    done = subprocess.run(
        [sys.executable, "-c", ONE_BY_ONE, *together],
        cwd=tmp_path, env={**os.environ, **ASCII}, capture_output=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "versé" / "recording.parquet").is_file()
    assert (tmp_path / "versé" / "é.parquet").is_file()
    assert (tmp_path / "versé" / "s" / "sweep.parquet").is_file()
    assert "versé" in (tmp_path / "versé" / "c" / "report.html").read_text(encoding="utf-8")


@pytest.mark.slow
def test_a_sweep_ends_with_its_work(tmp_path, cases):
    """Two of three once ended by an abort: Arrow's threads held pieces of a file of Python's."""
    words = ["sweep", "position_sine", *SHORT, "--vary", "seed=1,2", "--workers=1", "--out"]
    for number in range(cases(10)):
        command = [sys.executable, "-m", "ves_twin.cli.main", *words, str(number)]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, check=False)
        assert done.returncode == 0, done.stderr


def test_too_little_memory_is_one_line(monkeypatch, capsys):
    def full(arguments: object) -> int:
        raise MemoryError

    monkeypatch.setattr("ves_twin.cli.scenarios.execute", full)
    assert main(["scenarios"]) == 2
    assert capsys.readouterr().err.startswith("ves-twin: not enough memory")


@pytest.mark.parametrize("home", ["/dev/null", "/nowhere"])
def test_matplotlib_has_a_folder_where_home_is_none(home, monkeypatch, tmp_path):
    """A home that can be written but is a file, too; matplotlib would say so beside the result."""
    monkeypatch.setenv("HOME", home)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setenv("MPLCONFIGDIR", "")  # so that what is set here is taken back
    monkeypatch.delenv("MPLCONFIGDIR")
    _give_matplotlib_a_folder()
    assert Path(os.environ["MPLCONFIGDIR"]).is_dir()
