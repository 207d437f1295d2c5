"""ves-twin sweep: answers, folders, one line for what is wrong, and going on after a stop."""

import json
import signal
import subprocess
import sys
import time

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from ves_twin.cli.main import main
from ves_twin.cli.sweep_text import sweep_rows
from ves_twin.core.errors import InvalidInputError
from ves_twin.core.signals import SIGNALS
from ves_twin.report.sweep_picture import draw_sweep

SHORT = ["--set", "run.duration=0.2", "--set", "run.settle=0.2", "--workers", "1"]


def test_the_same_command_goes_on_in_its_folder_and_another_gets_its_own(
    capsys, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    command = ["sweep", "position_sine", "--vary", "seed=1,2", *SHORT]
    assert main([*command, "--json"]) == 0
    first = json.loads(capsys.readouterr().out)
    assert first["outcomes"] == {"completed": 2}
    assert first["found"] == 0
    assert main([*command, "--json"]) == 0
    again = json.loads(capsys.readouterr().out)
    assert (again["found"], again["table"]) == (2, first["table"])
    assert main(["sweep", "position_sine", "--vary", "seed=1", *SHORT]) == 0
    assert "completed 1" in capsys.readouterr().out
    folders = sorted(p.name for p in (tmp_path / "runs").iterdir())
    assert folders == ["position_sine-sweep", "position_sine-sweep-2"]


@pytest.mark.parametrize(
    ("scenario", "column", "says"),
    [
        ("position_sine", "tracking.y.rms", "rms of the tracking error"),
        ("beam_horizontal_truth", "error.y.rms", "rms of the emulation error"),
    ],
)
def test_a_sweep_prints_its_rows_with_what_was_measured(capsys, tmp_path, scenario, column, says):
    command = ["sweep", scenario, "--vary", "legs.gain=8,12", *SHORT, "--out", str(tmp_path)]
    assert main(command) == 0
    out = capsys.readouterr().out
    assert says in out
    head = next(line for line in out.splitlines() if "point  " in line and "outcome" in line)
    first = out.splitlines()[out.splitlines().index(head) + 1].split()
    assert head.split()[:4] == ["point", "legs.gain", "outcome", "x"]
    measured = pq.read_table(tmp_path / "sweep.parquet")[column].to_pylist()[0]
    assert first[:3] == ["0", "8", "completed"]
    assert float(first[4]) == pytest.approx(1e3 * measured, abs=6e-4)


def table_of(folder, outcomes, **columns):
    rows = len(outcomes)
    content = {"point": list(range(rows)), "outcome": outcomes, **columns}
    for n, axis in enumerate(SIGNALS["truth.pose"].axes):
        content[f"error.{axis}.rms"] = [1e-3 * (n + 1) * (k + 1) for k in range(rows)]
    path = folder / "sweep.parquet"
    pq.write_table(pa.table(content), path)
    return path


def test_a_sweep_is_drawn_with_a_line_for_each_setting_and_early_ends_as_crosses(tmp_path):
    outcomes = ["completed", "completed", "completed", "sensor_range"]
    columns = {"legs.gain": [8.0, 8.0, 12.0, 12.0], "gravity.age": [0, 1, 0, 1]}
    table = table_of(tmp_path, outcomes, **columns)
    figure = draw_sweep(table, {"legs.gain": "1/s", "gravity.age": ""})
    axes = figure.axes[1]  # y
    assert axes.get_title() == "y, mm"
    drawn = [(line.get_marker(), line.get_xydata().tolist()) for line in axes.lines]
    assert drawn == [
        ("o", [[8.0, 2.0], [12.0, 6.0]]),
        ("x", []),
        ("o", [[8.0, 4.0]]),
        ("x", [[12.0, 8.0]]),
    ]
    assert figure.axes[5].get_xlabel() == "legs.gain [1/s]"


def test_a_sweep_over_words_alone_is_not_drawn(tmp_path):
    table = table_of(tmp_path, ["completed", "completed"], **{"legs.filter": ["none", "error"]})
    with pytest.raises(InvalidInputError, match="a varied number"):
        draw_sweep(table, {"legs.filter": ""})


def test_a_long_sweep_prints_its_first_rows_alone(tmp_path):
    table = pa.table({"point": range(30), "plant": ["p" * 40] * 30, "outcome": ["lost"] * 30})
    pq.write_table(table, tmp_path / "sweep.parquet")
    lines = sweep_rows(tmp_path / "sweep.parquet", {"plant": ""})
    assert lines[-1] == "  ... and 18 rows more in the table"
    assert len(lines) == 14
    assert lines[1].split() == ["0", "p" * 21 + "...", "lost"]


BAD = [
    (["position_sine"], "one key or more"),
    (["position_sin", "--vary", "seed=1"], "did you mean 'position_sine'"),
    (["position_sine", "--vary", "legs.gian=1,2"], "did you mean 'legs.gain'"),
    (["position_sine", "--vary", "legs.gain=8..9"], "--random N"),
    (["position_sine", "--vary", "seed=1", "--random", "-1"], "1 to 100000"),
    (["position_sine", "--vary", "seed=1", "--engine", "dusk"], "did you mean 'dask'"),
    (["position_sine", "--vary", "seed=1", "--workers", "0"], "1 to 1024"),
    (["position_sine", "--vary", "seed=1", "--address", "x:1"], "--engine dask"),
    (["position_sine", "--vray", "seed=1"], "did you mean '--vary'"),
    (["position_sine", "--vary", "seed=1", "--seed", "-1"], "at least 0"),
    (["stability_map", "--vary", "seed=1"], "a procedure of many runs"),
]


@pytest.mark.parametrize(("words", "says"), BAD, ids=[" ".join(words) for words, _ in BAD])
def test_bad_input_gets_one_line_and_leaves_nothing(capsys, tmp_path, monkeypatch, words, says):
    monkeypatch.chdir(tmp_path)
    assert main(["sweep", *words]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert says in err
    assert err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_a_folder_of_another_sweep_is_refused(capsys, tmp_path):
    command = ["sweep", "position_sine", *SHORT, "--out", str(tmp_path / "one"), "--vary"]
    assert main([*command, "seed=1"]) == 0
    assert main([*command, "seed=2"]) == 2
    assert "holds another sweep: its vary is" in capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.parametrize(
    "how", [pytest.param(signal.SIGINT, marks=pytest.mark.nightly), signal.SIGKILL]
)
def test_a_sweep_that_is_stopped_goes_on_where_it_was(tmp_path, how):
    command = [
        *(sys.executable, "-m", "ves_twin.cli.main", "sweep", "position_sine", "--workers", "1"),
        *("--vary", "seed=1..4:4", "--set", "run.duration=3", "--out", str(tmp_path), "--json"),
    ]
    run = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    rows = tmp_path / "rows.jsonl"
    deadline = time.monotonic() + 120
    while time.monotonic() < deadline and not (rows.exists() and rows.read_bytes().count(b"\n")):
        time.sleep(0.01)
    run.send_signal(how)
    out, err = run.communicate(timeout=60)
    assert out == ""
    assert "Traceback" not in err
    assert run.returncode == (130 if how is signal.SIGINT else -signal.SIGKILL)
    assert not (tmp_path / "sweep.parquet").exists()
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    account = json.loads(done.stdout)
    assert 1 <= account["found"] < 4
    assert account["outcomes"] == {"completed": 4}
    assert pq.read_table(tmp_path / "sweep.parquet")["point"].to_pylist() == list(range(4))
