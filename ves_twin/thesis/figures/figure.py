"""FigureResult: a figure that was drawn, and the numbers in it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class FigureResult:
    """One figure of the thesis, drawn anew.

    Attributes:
        id: for instance "fig-5-12".
        title: what it shows.
        png: where it was drawn.
        numbers: what it says, by name with unit.
        notes: what to know when looking at it.
    """

    id: str
    title: str
    png: Path
    numbers: dict[str, float]
    notes: tuple[str, ...]
