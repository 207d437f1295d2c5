"""whole_file: a file that takes its name only once it is whole."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ves_twin.errors import FileAccessError


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """A path to write to, which becomes `path` at the end of the block, or nothing does.

    Raises:
        FileAccessError: the file cannot be written.
    """
    partial = path.with_name(path.name + ".partial")
    _check_target(path, partial)
    try:
        yield partial
        os.replace(partial, path)
    except OSError as error:
        raise FileAccessError(f"cannot write '{path}': {error.strerror or error}") from None
    finally:
        partial.unlink(missing_ok=True)


def _check_target(path: Path, partial: Path) -> None:
    if path.is_dir():
        raise FileAccessError(f"cannot write '{path}': it is a folder")
    if path.exists() and not os.access(path, os.W_OK):
        raise FileAccessError(f"cannot write '{path}': the file is read-only")
    try:
        partial.touch()
    except OSError as error:
        raise FileAccessError(f"cannot write '{path}': {error.strerror}") from None
