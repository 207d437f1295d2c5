"""save_picture: a matplotlib figure as PNG."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from ves_twin.core.whole_file import whole_file

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PICTURE_WIDTH, DPI = 7.0, 110
"""Width of a picture [inch] and its resolution."""


def save_picture(figure: Figure, path: Path, dpi: int = DPI) -> Path:
    """Write a figure as PNG, complete or not at all.

    Raises:
        FileAccessError: the file cannot be written.
    """
    with whole_file(path) as partial:
        figure.savefig(partial, format="png", dpi=dpi)
    return path
