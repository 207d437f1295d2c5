"""once: calls whose results all tests of a session share, whichever worker runs them.

A result lies in a folder that the controlling process makes and removes, keyed by the function and
its arguments; a file is locked while it is made. Each caller gets a copy of its own, to the last
bit what the call returns. Not for tests that replace a part of what runs.
"""

from __future__ import annotations

import fcntl
import hashlib
import os
import pickle
import shutil
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import ParamSpec, TypeVar

import pytest

from ves_twin.simulator.simulate import simulate

FOLDER = "VES_TWIN_TESTS_ONCE"

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")


def once(
    call: Callable[Arguments, Result], *args: Arguments.args, **kwargs: Arguments.kwargs
) -> Result:
    """`call(*args, **kwargs)`, carried out by the first test that asks for it.

    Args:
        call: a function of a module; what it returns depends on its arguments alone.
        args: its arguments; what cannot be pickled is refused by pickle.
        kwargs: the same by name.
    """
    name = f"{call.__module__}.{call.__qualname__}"
    key = hashlib.sha256(pickle.dumps((name, args, kwargs))).hexdigest()
    path = Path(os.environ[FOLDER]) / key
    with path.with_suffix(".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not path.is_file():
            made = pickle.dumps(call(*args, **kwargs), protocol=pickle.HIGHEST_PROTOCOL)
            path.write_bytes(made)
    return pickle.loads(path.read_bytes())


@pytest.fixture(scope="session")
def banks() -> Path:
    """A folder of signature libraries that all tests share, as those of a user's diagnoses do."""
    return Path(os.environ[FOLDER]) / "banks"


@pytest.fixture
def standing(monkeypatch: pytest.MonkeyPatch) -> None:
    """The rig that stands 20 s to tell the noise of a comparison stands once a session.

    In the place of `simulate` in `loop_noise` alone, for the body of a test: what a module's
    fixtures compare is made before it, so that `healthy_result` takes the path of a user.
    """
    monkeypatch.setattr("ves_twin.machines.ves2.loop_noise.simulate", partial(once, simulate))


@pytest.fixture
def unpictured(monkeypatch: pytest.MonkeyPatch) -> None:
    """A comparison without its page, whose pictures take most of its time; others draw it."""
    monkeypatch.setattr("ves_twin.report.comparison.page.comparison_page", lambda comparison: "")


def pytest_configure(config: pytest.Config) -> None:
    if not hasattr(config, "workerinput"):
        os.environ[FOLDER] = tempfile.mkdtemp(prefix="ves_twin-tests-")


def pytest_unconfigure(config: pytest.Config) -> None:
    if not hasattr(config, "workerinput"):
        shutil.rmtree(os.environ.pop(FOLDER), ignore_errors=True)
