"""output_folder: where a command writes."""

from __future__ import annotations

from pathlib import Path


def output_folder(given: str | None, name: str) -> Path:
    """The folder asked for, or the next free runs/NAME, runs/NAME-2, ..."""
    if given is not None:
        return Path(given)
    folder, number = Path("runs") / name, 1
    while folder.exists():
        number += 1
        folder = Path("runs") / f"{name}-{number}"
    return folder
