"""The command line: answers, exit codes, and one line for whatever is wrong."""

import json
import math
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from ves_twin.cli.main import COMMANDS, main
from ves_twin.core.recording.files import load_recording
from ves_twin.procedures.procedure import Procedure, Result, RunContext
from ves_twin.scenario.load import procedure_questions, scenario_questions
from ves_twin.simulator.outcome import Outcome

QUICK = ["--set", "run.duration=0.3", "--set", "run.settle=0.3", "--no-rrd"]


def test_scenarios_lists_every_question(capsys):
    assert main(["scenarios"]) == 0
    out = capsys.readouterr().out
    for name, question in (scenario_questions() | procedure_questions()).items():
        assert name in out
        assert question in out


def test_json_output_is_one_object_and_nothing_else(capsys, tmp_path):
    assert main(["scenarios", "--json"]) == 0
    assert set(json.loads(capsys.readouterr().out)) == set(
        scenario_questions() | procedure_questions()
    )
    assert main(["info", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["versions"]["mujoco"].startswith("3.17")
    assert main(["run", "position_sine", *QUICK, "--json", "--out", str(tmp_path)]) == 0
    assert json.loads(capsys.readouterr().out)["outcome"] == "completed"


class _Endless(Procedure):
    """Ends with numbers that JSON does not know, as `confirm_by_run` may."""

    def carry_out(self, conduct: RunContext) -> Result:
        return Result(Outcome.COMPLETED, {"growth": math.inf, "sd": [math.nan, 1.0]})


def test_a_procedure_s_json_has_null_for_what_is_not_finite(capsys, tmp_path, monkeypatch):
    found = _Endless(name="endless", question="how fast?", procedure="stability_map")
    where = "ves_twin.procedures.registry.load_procedure"
    monkeypatch.setattr(where, lambda name, changes: found)
    assert main(["run", "stability_map", "--json", "--out", str(tmp_path)]) == 0
    for text in (capsys.readouterr().out, (tmp_path / "summary.json").read_text()):
        assert "Infinity" not in text
        assert "NaN" not in text
        content = json.loads(text)
        assert (content["growth"], content["sd"]) == (None, [None, 1.0])


def test_run_writes_what_the_contract_names(capsys, tmp_path):
    command = ["run", "beam_horizontal_truth", "--set", "run.duration=1.5", "--seed", "4"]
    assert main([*command, "--out", str(tmp_path)]) == 0
    assert sorted(p.name for p in tmp_path.iterdir()) == [
        "recording.parquet",
        "run.rrd",
        "summary.json",
    ]
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert summary["outcome"] == "completed"
    assert summary["seed"] == 4
    assert set(summary["emulation_error"]) == {"x", "y", "z", "rx", "ry", "rz"}
    assert {"rms", "peak", "relative"} <= set(summary["emulation_error"]["y"])
    assert {"plant_hash", "duration", "timing"} <= set(summary)
    assert load_recording(tmp_path).info.seed == 4
    assert "emulation error" in capsys.readouterr().out


def test_runs_without_out_get_folders_of_their_own(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["run", "position_sine", *QUICK]) == 0
    assert main(["run", "position_sine", *QUICK]) == 0
    assert sorted(p.name for p in (tmp_path / "runs").iterdir()) == [
        "position_sine",
        "position_sine-2",
    ]


def test_run_that_ends_early_exits_3_and_keeps_its_rows(capsys, tmp_path):
    assert main(["run", "beam_horizontal_corrected", "--no-rrd", "--out", str(tmp_path)]) == 3
    assert len(load_recording(tmp_path)) > 5


BAD = [
    (["rnu"], "did you mean 'run'"),
    (["run"], "SCENARIO"),
    (["run", "beam_horizontal_trut"], "did you mean 'beam_horizontal_truth'"),
    (["run", "no/such/file.toml"], "does not exist"),
    (["run", "position_sine", "--set", "legs.gian=3"], "did you mean 'legs.gain'"),
    (["run", "position_sine", "--set", "legs.gain"], "KEY=VALUE"),
    (["run", "position_sine", "--set", "legs.gain=3 mm"], "1/s"),
    (["run", "position_sine", "--set", "run.duration=nan"], "finite"),
    (["run", "position_sine", "--set", "platform.start=[1,2]"], "6 numbers"),
    (["run", "position_sine", "--set", "parameters.leg.rod_mass=-2"], "at least 0 kg"),
    (["run", "position_sine", "--set", "parameters.leg.rod_mass=0"], "leg1/rod"),
    (["run", "position_sine", "--set", "parameters.leg.rod_mas=2"], "leg.rod_mass"),
    (["run", "position_sine", "--set", "platform.start=[0.5,0,0,0,0,0]"], "needs leg"),
    (["run", "position_sine", "--plant", "vse2"], "did you mean 'ves2'"),
    (["run", "position_sine", "--seed", "-1"], "at least 0"),
    (["run", "position_sine", "--seed", "one"], "one"),
    (["run", "position_sine", "--sede", "1"], "did you mean '--seed'"),
    (["blind", "make", "--singel", "1"], "did you mean '--single'"),
    (["--vresion"], "did you mean '--version'"),
    (["diagnose", "x.csv", "--workers", "2"], "unknown option '--workers'; known: --alternate"),
    (["run", "position_sine", "--set", "arm.start=[1e300,0,0]"], "two turns"),
    (["run", "position_sine", "--set", "platform.rate=0.001"], "greater than or equal to 1"),
    (["run", "position_sine", "--set", "parameters.sensor.corner=1e9"], "at most 1000"),
    (["run", "position_sine", "--set", "parameters.platform.base_radius=0"], "at least 0.1"),
    (
        [
            "run",
            "position_sine",
            "--set",
            "parameters.chamber.bore=0.01",
            "--set",
            "plant=ves2_pressure",
        ],
        "wider than the rod",
    ),
    (["run", "position_sine", "--set", "parameters.chamber.bore=0.06"], "hydraulic_model"),
    (["run", "position_sine", "--seed", "99999999999999999999"], "below 2^63"),
    (["view", "no/such/run.parquet"], "does not exist"),
    (["view", "no/such"], "run folder, recording or scenario no/such does not exist"),
    (["info", "--plant", "no.toml"], "does not exist"),
]


@pytest.mark.parametrize(("words", "says"), BAD, ids=[" ".join(words) for words, _ in BAD])
def test_bad_input_gets_one_line_and_exit_2(capsys, tmp_path, monkeypatch, words, says):
    monkeypatch.chdir(tmp_path)
    assert main(words) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert says in err
    assert err.count("\n") == 1
    assert "Traceback" not in err


@pytest.mark.parametrize("name", ["demoo", "runs/demoo", "position_sin"])
def test_view_names_the_nearest_run_folder_or_scenario(capsys, tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    for folder in ("demo", "runs/demo"):
        Path(folder).mkdir(parents=True)
        Path(folder, "recording.parquet").write_text("")
    assert main(["view", name]) == 2
    near = {"position_sin": "position_sine"}.get(name, name[:-1])
    assert f"did you mean '{near}'?" in capsys.readouterr().err


def recorded(folder, age):
    Path(folder).mkdir(parents=True)
    Path(folder, "diagnosis.rrd").write_bytes(b"no rerun file")
    os.utime(folder, (age, age))


def test_view_last_shows_what_was_written_last(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["view", "--last"]) == 2
    assert "there is no recording below runs/ yet" in capsys.readouterr().err
    recorded("runs/demo-2", 1e9)
    recorded("runs/demo", 2e9)
    assert main(["view", "--last"]) == 2  # a viewer that opened would wait for its window
    shown = capsys.readouterr().err
    assert "showing runs/demo\n" in shown
    assert "expected a rerun file" in shown


def test_view_of_a_folder_tells_of_a_newer_one_of_its_name(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    recorded("runs/demo", 1e9)
    recorded("runs/demo-2", 2e9)
    recorded("runs/demo-beam", 3e9)
    assert main(["view", "runs/demo"]) == 2
    assert "runs/demo-2 is newer; ves-twin view --last" in capsys.readouterr().err
    assert main(["view", "runs/demo-2"]) == 2
    assert "is newer" not in capsys.readouterr().err


@pytest.mark.parametrize("words", [[], ["runs/demo", "--last"]])
def test_view_takes_a_name_or_the_newest_and_not_both(capsys, words):
    assert main(["view", *words]) == 2
    assert "a scenario, a recording, or --last" in capsys.readouterr().err


def test_plant_file_of_another_version_gets_one_line(capsys, tmp_path):
    path = tmp_path / "rig.toml"
    path.write_text('schema = 99\nbase = "ves2"\n')
    assert main(["info", "--plant", str(path)]) == 2
    assert "schema version 99" in capsys.readouterr().err


def test_folder_that_cannot_be_made_gets_one_line(capsys, tmp_path):
    (tmp_path / "file").write_text("")
    assert main(["run", "position_sine", *QUICK, "--out", str(tmp_path / "file" / "x")]) == 2
    assert "cannot write" in capsys.readouterr().err


def test_live_view_without_a_display_gets_one_line(capsys, monkeypatch):
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    assert main(["view", "position_sine", "--live"]) == 2
    assert "needs a display" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "option"),
    [
        (["--set", "legs.gain=3"], "--set"),
        (["--plant", "ves2"], "--plant"),
        (["--seed", "0"], "--seed"),
        (["--controller", "a.py:Mine"], "--controller"),
        (["--out", "here"], "--out"),
        (["--no-rrd"], "--no-rrd"),
    ],
)
def test_view_of_a_recording_refuses_what_it_would_ignore(capsys, tmp_path, words, option):
    (tmp_path / "run.rrd").write_bytes(b"RRF2")
    assert main(["view", str(tmp_path / "run.rrd"), *words]) == 2
    error = capsys.readouterr().err
    assert f"{option} does nothing on a recording" in error
    assert error.count("\n") == 1


@pytest.mark.parametrize("words", [["--out", "here"], ["--no-rrd"], ["--web"]])
def test_live_view_refuses_what_it_would_ignore(capsys, words):
    assert main(["view", "position_sine", "--live", *words]) == 2
    assert f"{words[0]} does nothing with --live" in capsys.readouterr().err


class _Window:
    """A viewer's window that nobody closes."""

    cam = SimpleNamespace(lookat=np.zeros(3), distance=0.0, azimuth=0.0, elevation=0.0)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        pass

    def is_running(self):
        return True

    def sync(self):
        pass


def test_live_view_of_a_run_that_ends_early_exits_3(capsys, monkeypatch):
    import mujoco.viewer  # noqa: F401  (a name to replace; the command line imports it late)

    monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.setattr("mujoco.viewer.launch_passive", lambda *_, **__: _Window())
    weak = "parameters.sensor.range=[500.0,500.0,500.0,500.0,500.0,500.0]"
    words = ["view", "position_sine", "--live", "--set", "run.settle=0.1", "--set", weak]
    assert main(words) == 3
    assert "wrench_range" in capsys.readouterr().err


def test_info_tells_what_a_plant_changes(capsys, tmp_path):
    path = tmp_path / "rig.toml"
    path.write_text('schema = 1\nbase = "ves2"\n[parameters]\n"leg.rod_mass" = "2700 g"\n')
    assert main(["info", "--plant", str(path)]) == 0
    assert "leg.rod_mass  2.5 -> 2.7 kg" in capsys.readouterr().out


@pytest.mark.parametrize("command", list(COMMANDS))
def test_every_command_has_help(capsys, command):
    with pytest.raises(SystemExit) as caught:
        main([command, "--help"])
    assert caught.value.code == 0
    assert command in capsys.readouterr().out


@pytest.mark.slow
def test_ctrl_c_keeps_the_recording_and_exits_130(tmp_path):
    command = [
        *(sys.executable, "-m", "ves_twin.cli.main", "run", "position_sine", "--no-rrd"),
        *("--set", "run.duration=600", "--out", str(tmp_path)),
    ]
    run = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    stream = tmp_path / "recording.arrows"
    deadline = time.monotonic() + 120
    while time.monotonic() < deadline and not (stream.exists() and stream.stat().st_size > 3e5):
        time.sleep(0.05)
    run.send_signal(signal.SIGINT)
    out, _ = run.communicate(timeout=60)
    assert run.returncode == 130
    assert "interrupted" in out
    recording = load_recording(tmp_path)
    assert recording.info.outcome == "interrupted"
    assert len(recording) > 50


def test_help_needs_no_simulator():
    """`ves-twin --help` imports neither MuJoCo nor numba, so that it answers at once."""
    code = (
        "import sys, ves_twin.cli.main;"
        "sys.exit(any(m in sys.modules for m in ('mujoco', 'numba', 'rerun', 'pydantic')))"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


@pytest.mark.parametrize("given", [None, "3"])
def test_commands_take_one_thread_of_linear_algebra_unless_told_otherwise(given):
    """It is read when numpy is imported, so that must not have been before."""
    others = {name: value for name, value in os.environ.items() if not name.startswith("OPENBLAS")}
    told = {} if given is None else {"OPENBLAS_NUM_THREADS": given}
    script = (
        "import os, sys, ves_twin.cli;"
        "print(os.environ['OPENBLAS_NUM_THREADS'], 'numpy' in sys.modules)"
    )
    words = [sys.executable, "-c", script]
    done = subprocess.run(words, env=others | told, capture_output=True, text=True, check=True)
    assert done.stdout.split() == [given or "1", "False"]


@pytest.mark.parametrize(
    ("stiffness", "says"), [("1e18", "pole"), ("-1e12", "runs away|finite|pole")]
)
def test_emulated_system_that_cannot_be_followed_gets_one_line(capsys, tmp_path, stiffness, says):
    path = tmp_path / "base.toml"
    path.write_text(
        f"schema = 1\ncoupling = 'beam'\nmass = [1, 1, 1, 1, 1, 1]\ndamping = [0, 0, 0, 0, 0, 0]\n"
        f"stiffness = [{stiffness}, 0, 0, 0, 0, 0]\n"
    )
    command = ["run", "beam_horizontal_truth", *QUICK, "--set", f"platform.emulated={path}"]
    assert main([*command, "--out", str(tmp_path / "out")]) == 2
    err = capsys.readouterr().err
    assert err.count("\n") == 1
    assert any(word in err for word in says.split("|"))


def test_file_that_is_no_rerun_file_is_not_served(capsys, tmp_path):
    (tmp_path / "run.rrd").write_text("x")
    assert main(["view", str(tmp_path / "run.rrd"), "--web"]) == 2
    assert "a rerun file" in capsys.readouterr().err


def test_plant_that_lacks_numbers_says_which(capsys, tmp_path):
    path = tmp_path / "rig.toml"
    path.write_text("schema = 1\n")
    assert main(["info", "--plant", str(path)]) == 2
    assert "gravity and" in capsys.readouterr().err
