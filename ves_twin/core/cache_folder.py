"""cache_folder: a folder of the user's for what can be computed again, and nobody else's.

Numba unpickles what it finds there, so that whoever can write it can run code.
"""

from __future__ import annotations

import atexit
import os
import shutil
import stat
import tempfile
from collections.abc import Iterator
from contextlib import suppress
from functools import lru_cache
from pathlib import Path

PRIVATE = 0o700

_OTHERS = stat.S_IWGRP | stat.S_IWOTH


@lru_cache
def cache_folder(name: str) -> Path:
    """The folder of this name: made with mode 0700, the user's, behind no symbolic link.

    It lies in `$XDG_CACHE_HOME/ves_twin` or `~/.cache/ves_twin`, else in `ves_twin-UID` of the
    temporary place, else in a new folder there that is removed when the program ends.
    """
    for root in _roots():
        folder = root / name
        try:
            if _is_own(root):
                root.chmod(stat.S_IMODE(root.stat().st_mode) & ~_OTHERS)
                if _is_own(folder) and not folder.stat().st_mode & _OTHERS:
                    _try(folder)
                    return folder
        except OSError:
            continue
    folder = _scratch() / name
    folder.mkdir(mode=PRIVATE)
    return folder


def _roots() -> Iterator[Path]:
    """Where the folder may lie, the best place first."""
    given = Path(os.environ.get("XDG_CACHE_HOME") or "")
    if given.is_absolute():
        yield given / "ves_twin"
    else:
        home = Path(os.path.expanduser("~"))  # as it came, where nobody has this user's number
        if home.is_absolute():
            yield home / ".cache" / "ves_twin"
    yield Path(tempfile.gettempdir()) / f"ves_twin-{os.geteuid()}"


def _is_own(folder: Path) -> bool:
    """Whether a folder, made if it is missing, is the user's and no symbolic link."""
    if not os.path.lexists(folder):
        folder.parent.mkdir(parents=True, exist_ok=True)
        with suppress(FileExistsError):  # another program of the user's was faster
            folder.mkdir(mode=PRIVATE)
            folder.chmod(PRIVATE)  # whatever the umask says
    found = folder.lstat()
    return stat.S_ISDIR(found.st_mode) and found.st_uid == os.geteuid()


def _try(folder: Path) -> None:
    """Raise OSError where nothing can be written."""
    with tempfile.TemporaryFile(dir=folder):
        pass


@lru_cache
def _scratch() -> Path:
    folder = Path(tempfile.mkdtemp(prefix="ves_twin-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder
