"""find_data: a recording by its path, or in the folder of public data, with its checksum."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.missing_file import missing_file

if TYPE_CHECKING:
    from ves_twin.machines.mjcf.rig.description import Data

VARIABLE = "VES_TWIN_DATA"
"""Environment variable with the folder of public data sets; see models/machines/README.md."""


def find_data(name: str, data: Sequence[Data], folder: str | None = None) -> Path:
    """The file of a recording.

    A path that exists is taken as it is. Otherwise the file is looked for in a folder of public
    data, where those that are listed must have their published content.

    Args:
        name: a path, or a path inside the folder such as "emps/emps_train.csv".
        data: public recordings of the machine, with their checksums.
        folder: of public data; that of the environment variable VES_TWIN_DATA if None.

    Raises:
        FileAccessError: no such file; says where it was looked for and where it comes from.
        InvalidInputError: a listed file with other content.
    """
    told = {d.file: d for d in data}
    given = Path(name)
    if given.is_file():
        return given
    root = folder or os.environ.get(VARIABLE)
    listed = told.get(given.as_posix())
    if root and (Path(root) / given).is_file():
        path = Path(root) / given
        if listed and hashlib.sha256(path.read_bytes()).hexdigest() != listed.sha256:
            raise InvalidInputError(f"content of {path}", "another checksum", listed.source)
        return path
    where = f"here or in {root}" if root else f"here, and --data or {VARIABLE} names no folder"
    source = f"; its source: {listed.source}" if listed else ""
    raise missing_file("recording", name, f" {where}{source}")
