"""hold_folder: an output folder, made, and written by one command at a time.

The lock is flock on the folder itself: it ends with the process, and leaves nothing behind.
"""

from __future__ import annotations

import errno
import fcntl
import os
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from ves_twin.core.errors import FileAccessError, VesTwinWarning

_FOLDER = os.O_RDONLY | os.O_DIRECTORY
_FILE = os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW

_TAKEN = (errno.EWOULDBLOCK, errno.EAGAIN, errno.EACCES)
"""How the system says that somebody else holds a lock; any other error: there are none here."""


@dataclass(frozen=True)
class HeldFolder:
    """A folder that is held; what takes one writes into it without asking again."""

    path: Path


@contextmanager
def hold_folder(folder: Path | HeldFolder, new: bool = False) -> Iterator[HeldFolder]:
    """Make a folder and keep every other command out of it until the block ends.

    A folder made here that stays empty is removed again: a command that fails leaves nothing.

    Args:
        folder: where to; one that is held already stays so.
        new: refuse one that exists.

    Raises:
        FileAccessError: another command writes it, or it cannot be written.
        FileExistsError: `new`, and it is there.
    """
    if isinstance(folder, HeldFolder):
        yield folder
        return
    made = _make(folder, new)
    with _locked(folder, _FOLDER, fcntl.LOCK_EX, f"folder '{folder}'"), _removed_if_empty(made):
        _probe(folder)
        yield HeldFolder(folder)


@contextmanager
def hold_file(path: Path) -> Iterator[None]:
    """Keep other commands from writing a file, and from holding its folder, until the block ends.

    The folder is made as `hold_folder` makes it.

    Raises:
        FileAccessError: another command writes the file or holds the folder, or it cannot be made.
    """
    folder, lock = path.parent, path.with_name(f".{path.name}.lock")
    made = _make(folder)
    with (
        _locked(folder, _FOLDER, fcntl.LOCK_SH, f"folder '{folder}'"),
        _removed_if_empty(made),
        _locked(lock, _FILE, fcntl.LOCK_EX, f"file '{path}'"),
    ):
        try:
            yield
        finally:
            lock.unlink(missing_ok=True)


def _make(folder: Path, new: bool = False) -> list[Path]:
    """Make a folder; it and those of its parents that were not there, from the inside out."""
    made = [path for path in (folder, *folder.parents) if not path.exists()]
    try:
        folder.mkdir(parents=True, exist_ok=not new)
    except OSError as error:
        if new and isinstance(error, FileExistsError):
            raise
        raise _refused(folder, error) from None
    return made


@contextmanager
def _removed_if_empty(made: list[Path]) -> Iterator[None]:
    try:
        yield
    finally:
        with suppress(OSError):  # it holds something, and so do its parents
            for path in made:
                path.rmdir()


def _probe(folder: Path) -> None:
    try:
        probe = folder / f".{os.getpid()}.probe"
        probe.touch()
        probe.unlink()
    except OSError as error:
        raise _refused(folder, error) from None


def _refused(folder: Path, error: OSError) -> FileAccessError:
    return FileAccessError(f"cannot write into folder '{folder}': {error.strerror}")


@contextmanager
def _locked(path: Path, flags: int, mode: int, what: str) -> Iterator[None]:
    handle = _open_locked(path, flags, mode, what)
    try:
        yield
    finally:
        os.close(handle)


def _open_locked(path: Path, flags: int, mode: int, what: str) -> int:
    """A handle that holds the lock; opened again where the path was removed meanwhile."""
    while True:
        try:
            handle = os.open(path, flags, 0o666)
        except OSError as error:
            raise FileAccessError(f"cannot write {what}: {error.strerror}") from None
        try:
            _lock(handle, mode, what)
            if os.path.samestat(os.fstat(handle), os.stat(path)):
                return handle
        except FileNotFoundError:
            pass
        except BaseException:
            os.close(handle)
            raise
        os.close(handle)


def _lock(handle: int, mode: int, what: str) -> None:
    try:
        fcntl.flock(handle, mode | fcntl.LOCK_NB)
    except OSError as error:
        if error.errno in _TAKEN:
            raise FileAccessError(
                f"{what} is being written by another command; wait, or give another --out"
            ) from None
        warnings.warn(
            f"{what} lies on a file system without locks ({error.strerror});"
            " let no other command write it now",
            VesTwinWarning,
            stacklevel=6,
        )
