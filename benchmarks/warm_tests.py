"""Tests in forked children of one process, which has loaded what no mutant changes.

Reads a line of JSON on stdin for each run, {"tests": [...], "options": [...], "limit": seconds,
"seen": a file or ""}, and answers with one on stdout, {"code": exit code of pytest or null if it
hung, "seconds": ...}. Seconds are of the processor. Most of a short run is start-up, which is paid
once here. `seen` takes, for each test, the functions of the package that it called.
"""

from __future__ import annotations

import importlib
import json
import os
import resource
import shutil
import signal
import sys
import time
from collections.abc import Generator
from pathlib import Path
from types import FrameType

import pytest

OTHERS = (
    "hypothesis", "mujoco", "numba", "numpy", "pandas", "pint", "pyarrow.dataset",
    "pyarrow.parquet", "scipy.linalg", "scipy.optimize", "scipy.signal", "scipy.spatial",
    "scipy.stats",
)  # fmt: skip

POLL = 0.02
"""Seconds between two looks at a child."""

PATIENCE = 20.0
"""Seconds of the clock for one of the processor: what waits for ever uses none."""

FOLDER = "VES_TWIN_TESTS_ONCE"
"""Variable of the folder of what tests share, as tests/support/once.py names it."""

COMMON = ["-x", "-q", "-n", "0", "-m", "not slow", "--assert=plain", "-p", "no:cacheprovider"]


def main() -> None:
    for name in (*OTHERS, *sys.argv[1:]):
        importlib.import_module(name)
    for line in sys.stdin:
        asked = json.loads(line)
        words = [*COMMON, *asked["options"], *asked["tests"]]
        code, seconds = _run(words, asked["limit"], asked["seen"])
        sys.stdout.write(json.dumps({"code": code, "seconds": seconds}) + "\n")
        sys.stdout.flush()


class Seen:
    """Which functions each test calls, as "file:first line"; what one prepares, all of its file."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.package = str(Path.cwd() / "ves_twin")
        self.now: set[str] = set()
        self.called: dict[str, set[str]] = {}
        self.prepared: dict[str, set[str]] = {}

    def note(self, frame: FrameType, event: str, _: object) -> None:
        code = frame.f_code
        if event == "call" and code.co_filename.startswith(self.package):
            self.now.add(f"{os.path.relpath(code.co_filename)}:{code.co_firstlineno}")

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_setup(self, item: pytest.Item) -> Generator[None]:
        for path in Path(os.environ[FOLDER]).iterdir():
            # what tests share is made by each of them, to see what it calls
            shutil.rmtree(path) if path.is_dir() else path.unlink()
        yield from self._noted(self.prepared.setdefault(item.nodeid.split("::")[0], set()))

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_call(self, item: pytest.Item) -> Generator[None]:
        yield from self._noted(self.called.setdefault(item.nodeid, set()))

    def _noted(self, names: set[str]) -> Generator[None]:
        self.now = names
        sys.setprofile(self.note)
        try:
            return (yield)
        finally:
            sys.setprofile(None)

    def pytest_sessionfinish(self) -> None:
        both = {t: sorted(c | self.prepared[t.split("::")[0]]) for t, c in self.called.items()}
        self.path.write_text(json.dumps(both), encoding="utf-8")


def _run(words: list[str], limit: float, seen: str) -> tuple[int | None, float]:
    """Exit code and processor seconds."""
    child = os.fork()
    if child == 0:
        os.setsid()
        resource.setrlimit(resource.RLIMIT_CPU, (int(limit) + 1, int(limit) + 1))
        nowhere = os.open(os.devnull, os.O_RDWR)
        for stream in (0, 1, 2):
            os.dup2(nowhere, stream)
        code = 1
        try:
            code = int(pytest.main(words, [Seen(Path(seen))] if seen else []))
        finally:
            os._exit(code)
    end = time.monotonic() + PATIENCE * limit
    while time.monotonic() < end:
        number, status, used = os.wait4(child, os.WNOHANG)
        if number:
            code = os.waitstatus_to_exitcode(status)
            hung = code in {-signal.SIGXCPU, -signal.SIGKILL}
            return None if hung else code, used.ru_utime + used.ru_stime
        time.sleep(POLL)
    os.killpg(child, signal.SIGKILL)
    os.waitpid(child, 0)
    return None, limit


if __name__ == "__main__":
    main()
