"""arrow_file: a file opened for Arrow to read, by a name in any locale."""

from __future__ import annotations

import os
from pathlib import Path

import pyarrow as pa


def arrow_file(path: str | Path) -> pa.NativeFile:
    """The file, opened by Arrow itself.

    Arrow reads ahead in threads of its own. Of a file of Python's they may hold a piece until the
    interpreter is gone, and the process then ends by an abort, its work done.

    Raises:
        OSError: missing or unreadable, in the words of the system.
    """
    with open(path, "rb"):  # Arrow's own words name errno
        pass
    return pa.OSFile(os.fsencode(path))  # as bytes: Arrow takes texts in UTF-8 alone
