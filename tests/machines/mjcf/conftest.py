"""Where public data sets lie, if they do."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

FOLDERS = (os.environ.get("VES_TWIN_DATA"), Path(__file__).parents[3] / ".." / "shared" / "data")


@pytest.fixture(scope="session")
def data_folder() -> Path:
    """The folder of public data; the test is skipped where it is absent."""
    for folder in FOLDERS:
        if folder is not None and (Path(folder) / "emps" / "emps_train.csv").is_file():
            return Path(folder)
    pytest.skip("public data are absent: see models/machines/README.md, or set VES_TWIN_DATA")
