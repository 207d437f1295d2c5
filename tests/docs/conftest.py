"""The site, built once for all tests of a session."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from once import FOLDER, once

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="session")
def site():
    """The site as `make docs` builds it, elsewhere; notebooks have tests of their own."""
    return Path(once(built))


def built() -> str:
    """Builds the site; its folder."""
    folder = Path(os.environ[FOLDER]) / "site"
    done = subprocess.run(
        [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(folder)],
        cwd=ROOT,
        env={**os.environ, "NO_MKDOCS_2_WARNING": "1", "RUN_NOTEBOOKS": "no"},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return str(folder)
