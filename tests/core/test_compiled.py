"""The cache of compiled code knows every compiled source and does not change results."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import ves_twin
from ves_twin.core.compiled import sources_hash

PACKAGE = Path(ves_twin.__file__).parent

RUN = """
import hashlib, numpy as np, ves_twin as vt
changes = {"run.duration": 0.3, "run.settle": 0.3}
run = vt.simulate(vt.Scenario.load("beam_horizontal_truth", changes), seed=2)
digest = hashlib.sha256()
for name in sorted(run.signals):
    digest.update(np.ascontiguousarray(run[name]).tobytes())
print(digest.hexdigest())
"""


SAY = """
from ves_twin.core.compiled import say_that_it_compiles
from ves_twin.simulator.loop import run_ticks
say_that_it_compiles(run_ticks)
say_that_it_compiles(run_ticks)
"""

PLACE = "from ves_twin.simulator.loop import run_ticks; print(run_ticks.stats.cache_path)"


def copy_of_the_project(target: Path) -> Path:
    skip = shutil.ignore_patterns("__pycache__")
    for name in ("ves_twin", "models", "scenarios"):
        shutil.copytree(PACKAGE.parent / name, target / name, ignore=skip)
    return target


def result(project: Path, cache: Path) -> str:
    environment = {**os.environ, "PYTHONPATH": str(project), "XDG_CACHE_HOME": str(cache)}
    done = subprocess.run(
        [sys.executable, "-c", RUN],
        cwd=project, env=environment, capture_output=True, text=True, check=True,
    )  # fmt: skip
    return done.stdout.strip()


def words(project: Path, cache: Path) -> str:
    """What is said before a compilation; nothing where the cache has the loop."""
    environment = {**os.environ, "PYTHONPATH": str(project), "XDG_CACHE_HOME": str(cache)}
    done = subprocess.run(
        [sys.executable, "-c", SAY],
        cwd=project, env=environment, capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert done.stderr.count("\n") <= 1
    return done.stderr


def test_a_compilation_that_takes_a_minute_is_announced_once(tmp_path):
    assert "compiling" in words(PACKAGE.parent, tmp_path / "cache")


def test_what_another_copy_or_an_older_file_compiled_does_not_count(tmp_path):
    project, cache = copy_of_the_project(tmp_path / "project"), tmp_path / "cache"
    environment = {**os.environ, "PYTHONPATH": str(PACKAGE.parent), "XDG_CACHE_HOME": str(cache)}
    there = subprocess.run(
        [sys.executable, "-c", PLACE], env=environment, capture_output=True, text=True, check=True
    ).stdout.strip()
    Path(there).mkdir(parents=True, exist_ok=True)
    index = Path(there) / "loop.run_ticks-162.py311.nbi"
    index.touch()
    assert not words(PACKAGE.parent, cache)
    assert "compiling" in words(project, cache)
    os.utime(index, (0.0, 0.0))
    assert "compiling" in words(PACKAGE.parent, cache)


@pytest.mark.nightly
@pytest.mark.timeout(900)  # three compilations from nothing: a minute alone
def test_fresh_and_cached_compile_agree_and_an_edited_helper_is_compiled_anew(tmp_path):
    project = copy_of_the_project(tmp_path / "project")
    cache = tmp_path / "cache"
    assert words(project, cache)
    fresh = result(project, cache)
    assert result(project, cache) == fresh
    assert not words(project, cache)
    helper = project / "ves_twin" / "plant" / "physics" / "valve.py"
    text = helper.read_text()
    assert "s.decay[i] = np.exp(-step / p.lag[i])" in text
    helper.write_text(text.replace("np.exp(-step / p.lag[i])", "np.exp(-0.5 * step / p.lag[i])"))
    assert result(project, cache) != fresh
    helper.write_text(text)
    assert result(project, cache) == fresh


def test_hash_follows_every_compiled_file_and_the_numbers_they_share(tmp_path):
    package = copy_of_the_project(tmp_path) / "ves_twin"
    before = sources_hash(package)
    marked = [p for p in package.rglob("*.py") if "ves_twin.core.compiled" in p.read_text()]
    assert package / "simulator" / "codes.py" in marked
    assert len(marked) > 10
    for path in marked:
        text = path.read_text()
        path.write_text(text + "# edited\n")
        assert sources_hash(package) != before, path
        path.write_text(text)
    assert sources_hash(package) == before


def test_every_file_that_compiles_is_in_the_hash():
    for path in PACKAGE.rglob("*.py"):
        text = path.read_text()
        if "@compiled" in text or "njit" in text:
            assert "ves_twin.core.compiled" in text or path.name == "compiled.py", path


FORKED = """
import os, sys, time
from threading import Event, Thread
from numba.core.compiler_lock import global_compiler_lock
import ves_twin.core.compiled

begun = Event()

def compile_for_a_while():
    with global_compiler_lock:
        begun.set()
        time.sleep(0.5)

Thread(target=compile_for_a_while).start()
begun.wait()
child = os.fork()
if child == 0:
    os._exit(0 if global_compiler_lock._lock.acquire(timeout=10.0) else 7)
sys.exit(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system cannot fork")
def test_a_fork_while_a_thread_compiles_leaves_the_child_able_to_compile():
    """It waited for ever for a lock that a thread of its parent held, in one run of ten."""
    done = subprocess.run(
        [sys.executable, "-c", FORKED], capture_output=True, text=True, check=False, timeout=120
    )
    assert done.returncode == 0, done.stderr
