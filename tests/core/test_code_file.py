"""Code of a user's own: loaded by a flag alone, refused in one line."""

import pytest

from ves_twin.cli.main import main
from ves_twin.control.controller import PlatformController
from ves_twin.core.code_file import load_class
from ves_twin.core.errors import FileAccessError, InvalidInputError, PluginError, UnknownNameError
from ves_twin.core.recording.files import load_recording

CODE = """
import numpy as np
from ves_twin.control.controller import PlatformController

class Lift(PlatformController):
    @classmethod
    def build(cls, task):
        return cls()

    def update(self, time, readings):
        return np.array([0.0, 0.0, 0.01 * min(time, 1.0), 0.0, 0.0, 0.0])

    def snapshot(self):
        return None

    def restore(self, snapshot):
        pass

class Half(PlatformController):
    pass

class Other:
    pass
"""


@pytest.fixture
def code(tmp_path):
    path = tmp_path / "mine.py"
    path.write_text(CODE)
    return path


def test_a_class_of_a_file_is_loaded(code):
    assert load_class(f"{code}:Lift", PlatformController).__name__ == "Lift"


@pytest.mark.parametrize(
    ("text", "error", "words"),
    [
        ("{}:Lif", UnknownNameError, "did you mean 'Lift'"),
        ("{}:Half", PluginError, "lacks build"),
        ("{}:Other", PluginError, "not a class derived from PlatformController"),
        ("{}", InvalidInputError, "FILE.py:Class"),
        ("{}:", InvalidInputError, "FILE.py:Class"),
        ("no.py:Lift", FileAccessError, "does not exist"),
        ("mine.toml:Lift", InvalidInputError, "FILE.py:Class"),
    ],
)
def test_what_cannot_be_used_is_answered_in_one_line(code, text, error, words):
    with pytest.raises(error, match=words):
        load_class(text.format(code), PlatformController)


@pytest.mark.parametrize("broken", ["import nothing_like_it", "def", "raise ValueError('a\\nb')"])
def test_a_file_that_cannot_be_run_is_answered_in_one_line(tmp_path, broken):
    path = tmp_path / "broken.py"
    path.write_text(broken)
    with pytest.raises(PluginError, match="cannot be run") as caught:
        load_class(f"{path}:Lift", PlatformController)
    assert "\n" not in str(caught.value)


def test_a_run_takes_a_controller_of_one_s_own(code, tmp_path):
    words = ["run", "platform_tracking", "--controller", f"{code}:Lift", "--no-rrd"]
    words += ["--set", "run.duration=1.0", "--set", "plant=ves2_fast", "--out", str(tmp_path / "r")]
    assert main(words) == 0
    run = load_recording(tmp_path / "r")
    assert run["platform.command"][-1][2] == pytest.approx(0.01, abs=2e-4)  # a cycle
    assert any(e.kind == "controller" and "Lift" in e.message for e in run.info.events)


def test_a_procedure_takes_none(code, capsys):
    assert main(["run", "pped_release", "--controller", f"{code}:Lift"]) == 2
    assert "--controller" in capsys.readouterr().err
