"""new_canvas and save_canvas: a picture without a display and without global state."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from ves_twin.errors import FileAccessError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DPI = 110
"""Resolution of a picture."""


def new_canvas(width: float = 7.0, height: float = 4.0) -> Figure:
    """An empty figure of a size in inches."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg  # slow to import
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def save_canvas(figure: Figure, path: Path) -> Path:
    """Write a figure as PNG.

    Raises:
        FileAccessError: the file cannot be written.
    """
    try:
        figure.savefig(path, dpi=DPI)
    except OSError as error:
        raise FileAccessError(f"{path}: {error.strerror}") from None
    return path
