"""The caches are the user's own: what others can write is never unpickled."""

import os
import stat
import subprocess
import sys
from pathlib import Path

import pytest
from told import without_progress

from ves_twin.core import cache_folder as room
from ves_twin.core.cache_folder import cache_folder

FOREIGN = os.geteuid() + 1


@pytest.fixture
def home(tmp_path, monkeypatch):
    """A user whose cache folder cannot be written and whose temporary place is `tmp`."""
    (tmp_path / "tmp").mkdir()
    (tmp_path / "home").write_text("no folder")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "home"))
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "tmp"))
    yield tmp_path
    cache_folder.cache_clear()
    room._scratch.cache_clear()


@pytest.fixture(autouse=True)
def afresh():
    cache_folder.cache_clear()


def mode(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


def test_it_is_made_for_the_user_alone_whatever_the_umask(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    for umask in (0o000, 0o022, 0o277):
        before = os.umask(umask)
        try:
            folder = cache_folder(f"x-{umask}")
        finally:
            os.umask(before)
        assert folder == tmp_path / "ves_twin" / f"x-{umask}"
        assert mode(folder) == mode(folder.parent) == 0o700


def test_without_a_place_in_the_home_it_is_one_of_the_users_in_the_temporary_place(home):
    assert cache_folder("x") == home / "tmp" / f"ves_twin-{os.geteuid()}" / "x"


def test_a_folder_of_somebody_else_is_not_taken(home, monkeypatch):
    """Planted under the name that everybody can tell beforehand."""
    planted = home / "tmp" / f"ves_twin-{os.geteuid()}" / "x"
    planted.mkdir(parents=True)
    lstat = Path.lstat

    def foreign(path: Path) -> os.stat_result:
        found = lstat(path)
        return os.stat_result((*found[:4], FOREIGN, *found[5:])) if path == planted else found

    monkeypatch.setattr(Path, "lstat", foreign)
    found = cache_folder("x")
    assert found != planted
    assert found.parent.name.startswith("ves_twin-")
    assert mode(found.parent) == 0o700


@pytest.mark.parametrize("level", [0, 1])
def test_a_link_is_not_followed(home, level):
    elsewhere = home / "elsewhere"
    (elsewhere / "x").mkdir(parents=True)
    root = home / "tmp" / f"ves_twin-{os.geteuid()}"
    if level:
        root.mkdir()
        (root / "x").symlink_to(elsewhere / "x")
    else:
        root.symlink_to(elsewhere)
    found = cache_folder("x").resolve()
    assert not found.is_relative_to(elsewhere)


def test_a_folder_that_others_could_write_is_not_taken(home):
    root = home / "tmp" / f"ves_twin-{os.geteuid()}"
    (root / "x").mkdir(parents=True)
    (root / "x").chmod(0o777)
    root.chmod(0o777)
    assert cache_folder("x").parent != root
    assert mode(root) == 0o755  # the next one is safe there
    assert cache_folder("y").parent == root


def test_the_folder_of_last_resort_ends_with_the_program(tmp_path):
    code = f"""
import os, tempfile
from pathlib import Path
tempfile.tempdir = {str(tmp_path)!r}
(Path(tempfile.tempdir) / f"ves_twin-{{os.geteuid()}}").write_text("in the way")
from ves_twin.core.cache_folder import cache_folder
print(cache_folder("x").is_dir(), cache_folder("x") == cache_folder("x"))
"""
    environment = {**os.environ, "XDG_CACHE_HOME": "/dev/null"}
    words = [sys.executable, "-c", code]
    done = subprocess.run(words, env=environment, capture_output=True, text=True, check=True)
    assert done.stdout == "True True\n"
    assert [p.name for p in tmp_path.iterdir()] == [f"ves_twin-{os.geteuid()}"]


NOBODY = """
import pwd, sys
def nobody(uid):
    raise KeyError(uid)
pwd.getpwuid = nobody
from ves_twin.cli.main import main
if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
"""


@pytest.mark.parametrize(
    "words",
    [
        ["info"],
        pytest.param(
            ["run", "position_sine", "--set", "run.duration=0.1", "--out", "out"],
            marks=pytest.mark.nightly,  # compiles the whole loop
        ),
        pytest.param(["reproduce", "fig-5-3", "--out", "out"], marks=pytest.mark.slow),
    ],
    ids=lambda words: words[0],
)
def test_a_user_without_a_name_and_a_home_can_work(tmp_path, words):
    """As in a container: HOME is not set, and nobody knows the number of the user."""
    (tmp_path / "nobody.py").write_text(NOBODY)
    gone = {"HOME", "XDG_CACHE_HOME", "MPLCONFIGDIR", "LOGNAME", "USER"}
    kept = {name: value for name, value in os.environ.items() if name not in gone}
    done = subprocess.run(
        [sys.executable, str(tmp_path / "nobody.py"), *words],
        cwd=tmp_path, env=kept, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert without_progress(done.stderr) == ""
