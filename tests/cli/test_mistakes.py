"""Mistakes of a newcomer with files of their own: one line says what came, and nothing is left."""

import subprocess
import sys

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from ves_twin.cli.main import main

LOG = "t [s];x [mm]\n" + "\n".join(f"{k / 100};{900 + k}" for k in range(100))
MAP = 'schema = 1\n[clock]\ncolumn = "t [s]"\n'
CHANNEL = '[[channel]]\nfrom = "x [mm]"\nto = "leg.length.1"\n'


@pytest.fixture
def bench(tmp_path, monkeypatch):
    """A folder with a log, maps, a file where a folder is wanted, a recording of lengths alone."""
    monkeypatch.chdir(tmp_path)
    files = {
        "lab.csv": LOG,
        "ok.toml": MAP + CHANNEL,
        "twice.toml": MAP + 2 * CHANNEL,
        "unit.toml": MAP + CHANNEL + 'unit = "mN"\n',
        "in_the_way": "",
        "lab.toml": 'scenario = "identify_fast"\n[window]\nstart = "20 s"\n',
    }
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    return tmp_path


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (
            "import lab.csv --map twice.toml --out r.parquet",
            "twice.toml: channel: two columns go to leg.length.1",
        ),
        (
            "import lab.csv --map unit.toml --out r.parquet",
            "unit of x [mm] for leg.length.1: got 'mN', expected a unit that converts to m",
        ),
        (
            "import lab.csv --map ok.toml --out in_the_way/r.parquet",
            "cannot write into folder 'in_the_way': File exists",
        ),
        ("import lab.csv --out r.parquet", "import: the following arguments are required: --map"),
        ("run position_sine --seed x", "run: argument --seed: invalid int value: 'x'"),
        ("compare lab.csv --experiment lab.toml", "`ves-twin import` makes one of a log"),
        ("trend . --plant my_rig.toml", "plant file 'my_rig.toml' does not exist"),
        (
            "run position_sine --set effects.valve_null.leg.3.null=6",
            "got 6, expected -0.05 to 0.05\n",
        ),
    ],
)
def test_one_line_and_nothing_written(bench, capsys, words, line):
    before = sorted(bench.rglob("*"))
    assert main(words.split()) == 2
    out, error = capsys.readouterr()
    assert (out, error.count("\n")) == ("", 1)
    assert line in error
    assert sorted(bench.rglob("*")) == before


def test_a_recording_that_lacks_what_the_rig_was_told_wants_an_experiment(bench, capsys):
    assert main(["import", "lab.csv", "--map", "ok.toml", "--out", "rec.parquet"]) == 0
    before = sorted(bench.rglob("*"))
    capsys.readouterr()
    assert main(["diagnose", "rec.parquet", "--out", "found"]) == 2
    assert "got 'no leg.command', expected what the rig was told" in capsys.readouterr().err
    assert sorted(bench.rglob("*")) == before


def test_a_window_beyond_the_end_has_no_rows(bench, capsys):
    rows = np.arange(200)
    names = [f"leg.command.{i}" for i in range(1, 7)] + [f"leg.length.{i}" for i in range(1, 7)]
    table = {"t [s]": rows / 79.0, **{name: np.full(200, 1.0) for name in names}}
    pq.write_table(pa.table(table), bench / "log.parquet")
    channels = "".join(f'[[channel]]\nfrom = "{n}"\nto = "{n}"\nunit = "m"\n' for n in names)
    (bench / "six.toml").write_text(MAP + channels)
    assert main(["import", "log.parquet", "--map", "six.toml", "--out", "rec.parquet"]) == 0
    assert main(["compare", "rec.parquet", "--experiment", "lab.toml"]) == 2
    assert "got '0 rows between 20 and" in capsys.readouterr().err


@pytest.mark.parametrize(
    "words",
    [
        "compare no.csv",
        "diagnose no.csv --held-out lab.csv",
        "diagnose lab.csv --plant no.toml",
        "plan --plant no.toml",
        "new no.xml lab.csv",
    ],
)
def test_a_file_that_is_not_there_is_told_before_anything_heavy_is_imported(bench, words):
    """Each of these took two seconds of processor time for one line."""
    script = (
        "import sys; from ves_twin.cli.main import main; code = main(sys.argv[1:]);"
        " print(code, *{'mujoco', 'numba', 'scipy', 'pyarrow', 'pydantic'} & sys.modules.keys())"
    )
    command = [sys.executable, "-c", script, *words.split()]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["2"]
    assert "does not exist" in done.stderr
