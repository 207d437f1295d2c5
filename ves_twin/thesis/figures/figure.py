"""FigureResult: a figure of the thesis as a picture and as numbers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from ves_twin.plant.plant import Plant


@dataclass(frozen=True)
class FigureResult:
    """What drawing a figure gave.

    Attributes:
        id: for instance "fig-5-12".
        title: the caption of the thesis, shortened.
        png: the picture.
        numbers: what the picture says, by name with its unit.
        notes: what is assumed or does not hold.
    """

    id: str
    title: str
    png: Path
    numbers: dict[str, float]
    notes: tuple[str, ...] = ()


DrawFigure = Callable[[Plant, Path, bool], FigureResult]
"""(plant, folder, quick) -> result; quick measures fewer points."""
