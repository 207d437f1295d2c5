"""stderr of a command holds its one line, or nothing: no warnings, no output of a parser."""

import subprocess
import sys

import numpy as np
import pytest
from mcap.writer import Writer
from told import without_progress

DECOUPLED = """schema = 1
coupling = "decoupled"
mass = [1, 1, 1, 1, 1, 1]
damping = [1e300, 1e300, 1e300, 1e300, 1e300, 1e300]
stiffness = [1e4, 1e4, 1e4, 1, 1, 1]
"""

MAP = """schema = 1
[clock]
column = "t"
unit = "s"
[[channel]]
from = "x"
to = "leg.length.1"
unit = "m"
scale = 1e308
"""

CALIBRATION = """schema = 1
[sensor]
identity = "a"
matrix = [[1, 0, 0, 0, 0, 0], [0, 1, 0, 0, 0, 0], [0, 0, 1, 0, 0, 0],
          [0, 0, 0, 1, 0, 0], [0, 0, 0, 0, 1, 0], [0, 0, 0, 0, 0, 1]]
zero = [HUGE, 0, 0, 0, 0, 0]
[arm]
identity = "b"
[model]
names = []
"""


def told(*words, folder):
    """Exit code and stderr of a command, run as a user runs it."""
    command = [sys.executable, "-m", "ves_twin.cli.main", *map(str, words)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=folder)
    return done.returncode, without_progress(done.stderr)


def rows(path, count=100, scale=1.0):
    path.write_text("t,x\n" + "".join(f"{i},{i * scale}\n" for i in range(count)))


def test_a_row_of_another_width_with_bytes_that_are_no_text_is_counted(tmp_path):
    rows(tmp_path / "a.csv")
    with (tmp_path / "a.csv").open("ab") as file:
        file.write(b"5,6,\xff7\n200,1\n")
    assert told("inspect", "a.csv", folder=tmp_path) == (0, "")


def test_a_scale_beyond_doubles_leaves_cells_missing(tmp_path):
    rows(tmp_path / "a.csv", scale=1e5)
    (tmp_path / "map.toml").write_text(MAP)
    words = ("import", "a.csv", "--map", "map.toml", "--out", "a.parquet")
    assert told(*words, folder=tmp_path) == (0, "")


@pytest.mark.parametrize("what", ["platform.emulated", "gravity.file", "motion"])
def test_absurd_numbers_of_a_scenario_are_refused_in_one_line(what, tmp_path):
    (tmp_path / "e.toml").write_text(DECOUPLED)
    (tmp_path / "c.toml").write_text(CALIBRATION.replace("HUGE", "1" + "0" * 400))
    words = {
        "platform.emulated": ("beam_horizontal_truth", "--set", "platform.emulated=e.toml"),
        "gravity.file": (
            "beam_model_method", "--set", "gravity.file=c.toml",
        ),
        "motion": ("position_sine", "--set", "platform.motion.frequency=[1e308, 1e308, 0, 0, 0, 0]"),
    }[what]  # fmt: skip
    short = ("--set", "run.duration=0.05", "--set", "run.settle=0.05", "--out", "run")
    code, said = told("run", *words, *short, folder=tmp_path)
    assert code == 2
    assert said.count("\n") == 1, said
    assert said.startswith("ves-twin: ")


def test_definitions_that_a_parser_refuses_are_named_by_us_alone(tmp_path):
    with (tmp_path / "a.mcap").open("wb") as stream:
        writer = Writer(stream)
        writer.start()
        schema = writer.register_schema("a/msg/B", "ros2msg", b"float64 2x\nno such\n")
        channel = writer.register_channel("/a", "cdr", schema)
        writer.add_message(channel, 1, b"\0" * 12, 1)
        writer.finish()
    assert told("inspect", "a.mcap", folder=tmp_path) == (0, "")


def test_a_header_that_python_warns_of_is_no_matter_for_the_user(tmp_path):
    np.save(tmp_path / "a.npy", np.arange(100.0))
    content = (tmp_path / "a.npy").read_bytes()
    (tmp_path / "a.npy").write_bytes(content.replace(b"(100,)", b"(1is0)"))
    code, said = told("inspect", "a.npy", folder=tmp_path)
    assert (code, said.count("\n")) == (2, 1)
