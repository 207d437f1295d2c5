"""whole_file: a file that appears complete or not at all."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from ves_twin.core.errors import FileAccessError, one_line


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """A name to write under; the file gets its own name when the block ends well.

    A reader never sees half of it, and a disk that fills up leaves what was there before. Inside
    the block only the file should be written: an OSError there counts as its own.

    Raises:
        FileAccessError: it cannot be written: read-only folder, full disk.
    """
    _check_target(path)
    partial = path.with_name(f".{path.name}.{os.getpid()}.partial")  # two programs may write it
    try:
        yield partial
        _to_disk(partial)
        os.replace(partial, path)
    except OSError as error:
        reason = error.strerror or one_line(error)
        raise FileAccessError(f"cannot write {path}: {reason}") from None
    finally:
        with suppress(OSError):
            partial.unlink(missing_ok=True)


def check_writable(path: Path) -> None:
    """Raise FileAccessError if a file could not be written; nothing is left behind."""
    _check_target(path)
    probe = path.with_name(f".{path.name}.{os.getpid()}.probe")
    try:
        probe.touch()
        probe.unlink()
    except OSError as error:
        raise FileAccessError(f"cannot write {path}: {error.strerror}") from None


def write_whole(path: Path, text: str) -> None:
    """Write a text file, UTF-8, complete or not at all; raises as `whole_file`.

    Names of files that the locale could not decode keep their bytes.
    """
    with whole_file(path) as partial:
        partial.write_text(text, encoding="utf-8", errors="surrogateescape")


def _check_target(path: Path) -> None:
    if path.is_dir():
        raise FileAccessError(f"cannot write {path}: it is a folder")
    if path.exists() and not os.access(path, os.W_OK):
        raise FileAccessError(f"cannot write {path}: the file is read-only")


def _to_disk(path: Path) -> None:
    with path.open("rb+") as file:
        os.fsync(file.fileno())
