"""A disk that is full: one line, exit code 2, and no file that is half written.

A limit on the size of a file stands for the disk; it holds for root too.
"""

import subprocess
import sys

import pytest
from told import without_progress

from ves_twin.core.recording.files import load_recording

PROGRAM = """
import resource, sys
from ves_twin.cli.main import main
if __name__ == "__main__":
    limit = int(sys.argv[1])
    resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
    sys.exit(main(sys.argv[2:]))
"""

RUN = ["run", "position_sine", "--set", "run.settle=0.3", "--set"]


def on_a_disk_of(limit: int, tmp_path, words: list[str]) -> str:
    """The one line that a command ends with."""
    (tmp_path / "limited.py").write_text(PROGRAM)
    command = [sys.executable, str(tmp_path / "limited.py"), str(limit), *words]
    done = subprocess.run(
        [*command, "--out", str(tmp_path / "out")],
        capture_output=True, text=True, check=False, timeout=120,
    )  # fmt: skip
    assert done.returncode == 2, done.stderr
    assert done.stdout == ""
    lines = without_progress(done.stderr).strip().split("\n")
    assert len(lines) == 1, done.stderr
    assert lines[0].startswith("ves-twin: cannot write")
    assert "File too large" in lines[0]
    return lines[0]


def left(tmp_path) -> list[str]:
    return sorted(p.name for p in (tmp_path / "out").iterdir())


def test_a_run_keeps_the_rows_that_the_disk_took(tmp_path):
    # rows are handed over twice a second of the clock on the wall: a slow machine makes small pieces
    said = on_a_disk_of(1_000_000, tmp_path, [*RUN, "run.duration=30"])
    assert "rows before are kept" in said
    assert left(tmp_path) == ["recording.arrows"]
    assert len(load_recording(tmp_path / "out")) > 10


def test_a_run_on_a_disk_without_any_room_leaves_nothing(tmp_path):
    on_a_disk_of(1000, tmp_path, [*RUN, "run.duration=0.3"])
    assert left(tmp_path) in ([], ["recording.arrows"])


@pytest.mark.slow
def test_a_run_whose_rerun_file_does_not_fit_keeps_the_recording(tmp_path):
    on_a_disk_of(400_000, tmp_path, [*RUN, "run.duration=4"])
    assert left(tmp_path) == ["recording.parquet", "summary.json"]


@pytest.mark.slow
def test_a_sweep_says_which_file_and_keeps_its_rows_whole(tmp_path):
    words = ["sweep", "position_sine", "--vary", "seed=1,2", "--workers", "1"]
    on_a_disk_of(3000, tmp_path, [*words, "--set", "run.duration=0.2"])
    assert left(tmp_path) == ["rows.jsonl", "sweep.json", "timing.parquet"]
    assert (tmp_path / "out" / "rows.jsonl").read_bytes().count(b"\n") == 2
