"""missing_file: the error of a path that is not there, with the nearest name of its folder."""

from __future__ import annotations

import difflib
from pathlib import Path

from ves_twin.core.errors import FileAccessError

NEAR = 0.6
"""Likeness of two names from which one is taken for the other's misspelling (difflib's usual)."""


def missing_file(kind: str, path: str | Path, where: str = "") -> FileAccessError:
    """What to raise where a file does not exist.

    Args:
        kind: word for messages, for instance "recording"; empty for a file of any kind.
        path: as it was given.
        where: further words on where it was looked for.
    """
    what = f"{kind} file" if kind else "file"
    return FileAccessError(f"{what} '{path}' does not exist{where}{_hint(Path(path))}")


def _hint(path: Path) -> str:
    """The file of the same folder whose name is nearest; else whether that folder is there."""
    folder = path.parent
    try:
        names = sorted(other.name for other in folder.iterdir() if other.is_file())
    except OSError:
        return f"; nor does its folder '{folder}'" if not folder.is_dir() else ""
    near = difflib.get_close_matches(path.name, names, n=1, cutoff=NEAR)
    return f"; did you mean '{folder / near[0]}'?" if near else ""
