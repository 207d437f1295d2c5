"""compiled: numba compilation with a cache folder that knows every compiled source.

Numba's own cache looks at the file of the outermost function only: an edited helper in another
file would silently run the old physics. Here the folder's name carries a hash of all of them.
"""

from __future__ import annotations

import hashlib
import os
import sys
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import TypeVar, cast

import numba
import numpy as np
from numba.core import config as numba_config
from numba.core.compiler_lock import global_compiler_lock

from ves_twin.core.cache_folder import cache_folder

Function = TypeVar("Function", bound=Callable[..., object])

MARK = "ves_twin.core.compiled"
"""Files that import this module hold compiled code and enter the hash."""

if hasattr(os, "register_at_fork"):  # a child has no thread that would open the lock again
    os.register_at_fork(
        before=global_compiler_lock.acquire,
        after_in_parent=global_compiler_lock.release,
        after_in_child=global_compiler_lock.release,
    )


def sources_hash(package: Path) -> str:
    """Hash over every source file below `package` that holds compiled code."""
    digest = hashlib.sha256(f"{numba.__version__} {np.__version__}".encode())
    for path in sorted(package.rglob("*.py")):
        text = path.read_bytes()
        if MARK.encode() in text:
            digest.update(path.relative_to(package).as_posix().encode() + b"\0" + text + b"\0")
    return digest.hexdigest()[:16]


@lru_cache(maxsize=1)
def compiled_folder() -> Path:
    """Folder of the compiled code: per user, named by the hash of the sources."""
    return cache_folder(f"numba-{sources_hash(Path(__file__).resolve().parent.parent)}")


def compiled(function: Function) -> Function:
    """Compile a function with numba: cached, without the GIL, without fast-math.

    Fast-math is off because a fresh and a cached compile would then give different runs.
    """
    before = numba_config.CACHE_DIR
    numba_config.CACHE_DIR = str(compiled_folder())
    try:
        return cast("Function", numba.njit(cache=True, nogil=True, error_model="numpy")(function))
    finally:
        numba_config.CACHE_DIR = before


@lru_cache
def say_that_it_compiles(longest: Callable[..., object], takes: str = "about a minute") -> None:
    """Say on stderr what the first run after an installation or an edit waits for.

    Args:
        longest: the compiled function that takes by far the longest; it stands for the others.
        takes: how long that is.
    """
    if not _kept(longest):
        sys.stderr.write(f"compiling the inner loop, once: {takes}\n")  # in one piece
        sys.stderr.flush()


def _kept(function: Callable[..., object]) -> bool:
    """Whether the cache holds a function as its file is now; numba goes by the file's time."""
    source = Path(function.__code__.co_filename)
    kept = Path(function.stats.cache_path).glob(f"{source.stem}.{function.__name__}-*.nbi")  # type: ignore[attr-defined]
    return any(index.stat().st_mtime >= source.stat().st_mtime for index in kept)
