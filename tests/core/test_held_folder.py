"""One command at a time writes a folder; the lock ends with the process and leaves nothing."""

import errno
import fcntl
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import ves_twin as vt
from ves_twin.cli.main import COMMANDS, build_parser, main
from ves_twin.cli.output_folder import output_folder
from ves_twin.core.errors import FileAccessError, VesTwinWarning
from ves_twin.core.held_folder import HeldFolder, hold_file, hold_folder
from ves_twin.core.recording.files import load_recording, save_recording

HOLD = """
import sys, time
from pathlib import Path
from ves_twin.core.held_folder import hold_folder
with hold_folder(Path(sys.argv[1])):
    print("held", flush=True)
    time.sleep(600)
"""


@pytest.fixture
def holder(tmp_path):
    """Another process that holds the folder `out`."""
    words = [sys.executable, "-c", HOLD, str(tmp_path / "out")]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline() == "held\n"
        yield process
        process.kill()


@pytest.fixture
def recording(tmp_path) -> Path:
    """A recording of a short run."""
    run = vt.simulate(vt.Scenario.load("position_sine", {"run.duration": 0.1, "run.settle": 0.2}))
    save_recording(run, tmp_path / "r.parquet")
    return tmp_path / "r.parquet"


def words_of(command: str, tmp_path: Path, recording: Path) -> list[str]:
    """A command that would write the folder `out`."""
    (tmp_path / "map.toml").write_text("schema = 1\n")
    out = str(tmp_path / "out")
    given = {
        "run": ["position_sine", "--set", "run.duration=0.1"],
        "view": ["position_sine", "--set", "run.duration=0.1"],
        "sweep": ["position_sine", "--vary", "seed=1,2"],
        "diagnose": [str(recording)],
        "trend": [str(recording), "--plant", "emps"],
        "compare": [str(recording)],
        "blind": ["make"],
        "plan": ["--plant", "pendulum", "--design", "causes"],
        "reproduce": ["fig-5-2"],
        "inspect": [str(recording)],
        "import": [str(recording), "--map", str(tmp_path / "map.toml")],
        "export": [str(recording), "--format", "csv"],
        "new": [str(recording), str(recording)],
    }
    files = {"inspect", "import", "export", "new"}
    inside = f"{out}/r.parquet" if command in files else out
    return [command, *given[command], "--out", inside]


def commands_that_write() -> list[str]:
    """Every command that takes --out, whatever is registered."""
    choices = build_parser()._subparsers._group_actions[0].choices
    return [name for name in COMMANDS if "--out" in choices[name].format_help()] + ["blind"]


@pytest.mark.parametrize("command", commands_that_write())
def test_a_second_command_in_a_folder_is_refused_in_one_line(
    command, holder, recording, tmp_path, capsys
):
    assert main(words_of(command, tmp_path, recording)) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.splitlines()[-1].endswith("by another command; wait, or give another --out")
    assert list((tmp_path / "out").iterdir()) == []


def test_a_recorded_run_keeps_its_folder_to_itself(tmp_path):
    """Two runs in one folder once left rows of the one under the name of the other."""
    scenario = vt.Scenario.load("position_sine", {"run.duration": 0.5, "run.settle": 0.2})
    refused = []

    def other(reached: float) -> None:
        with pytest.raises(FileAccessError) as caught:
            vt.record(scenario, tmp_path, seed=2)
        refused.append(str(caught.value))

    vt.record(scenario, tmp_path, seed=1, progress=other)
    assert refused
    assert all("another command" in text for text in refused)
    kept, alone = load_recording(tmp_path), vt.simulate(scenario, seed=1)
    assert kept.info.seed == 1
    assert np.array_equal(kept["sensor.wrench"], alone["sensor.wrench"])


def test_a_lock_ends_with_its_process_and_leaves_nothing(holder, tmp_path):
    with pytest.raises(FileAccessError, match="another command"), hold_folder(tmp_path / "out"):
        pass
    holder.kill()
    holder.wait()
    with hold_folder(tmp_path / "out") as held:
        assert list(held.path.iterdir()) == []


def test_what_holds_a_folder_hands_it_on(tmp_path):
    with hold_folder(tmp_path) as held, hold_folder(held) as again:
        assert again == held == HeldFolder(tmp_path)


def test_a_folder_that_stays_empty_is_removed_with_its_parents(tmp_path):
    inner = tmp_path / "a" / "b"
    with hold_folder(inner):
        assert inner.is_dir()
    assert not (tmp_path / "a").exists()
    with hold_folder(inner):
        (inner / "kept").touch()
    assert (inner / "kept").is_file()
    with pytest.raises(FileExistsError), hold_folder(inner, new=True):
        pass


def test_files_of_one_folder_are_written_side_by_side_but_each_once(tmp_path):
    with hold_file(tmp_path / "a"), hold_file(tmp_path / "b"):
        with pytest.raises(FileAccessError, match=r"^file .* another"), hold_file(tmp_path / "a"):
            pass
        with pytest.raises(FileAccessError, match=r"^folder .* another"), hold_folder(tmp_path):
            pass
    assert list(tmp_path.iterdir()) == []


def test_a_lock_file_that_a_kill_left_blocks_nothing(tmp_path):
    (tmp_path / ".a.lock").touch()
    with hold_file(tmp_path / "a"):
        pass
    assert list(tmp_path.iterdir()) == []


def test_a_lock_file_that_is_a_link_is_not_followed(tmp_path):
    (tmp_path / ".a.lock").symlink_to(tmp_path / "elsewhere")
    with pytest.raises(FileAccessError), hold_file(tmp_path / "a"):
        pass
    assert not (tmp_path / "elsewhere").exists()


def test_a_file_system_without_locks_is_told_in_one_line_and_written(tmp_path, monkeypatch):
    def none(handle: int, mode: int) -> None:
        raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))

    monkeypatch.setattr(fcntl, "flock", none)
    with pytest.warns(VesTwinWarning, match="without locks") as told, hold_folder(tmp_path):
        (tmp_path / "written").touch()
    assert [str(one.message).count("\n") for one in told] == [0]


def test_a_run_without_out_takes_the_next_free_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with output_folder(None, "x") as first, output_folder(None, "x") as second:
        assert (str(first.path), str(second.path)) == ("runs/x", "runs/x-2")
