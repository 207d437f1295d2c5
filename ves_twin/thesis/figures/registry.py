"""FIGURES: every figure that can be drawn, by id."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from ves_twin.plant.plant import Plant
from ves_twin.thesis.figures.bode import draw_figure_5_2, draw_figure_5_12
from ves_twin.thesis.figures.chapter_4 import CHAPTER_4
from ves_twin.thesis.figures.figure import FigureResult
from ves_twin.thesis.figures.leg_filter import draw_figure_5_3, draw_figure_5_5
from ves_twin.thesis.figures.poles import draw_figure_5_8, draw_figure_5_10
from ves_twin.thesis.figures.positioning_error import draw_figure_5_11
from ves_twin.thesis.figures.step import draw_figure_5_13

FIGURES: dict[str, Callable[[Plant, Path, bool], FigureResult]] = {
    **CHAPTER_4,
    "fig-5-2": draw_figure_5_2,
    "fig-5-3": draw_figure_5_3,
    "fig-5-5": draw_figure_5_5,
    "fig-5-8": draw_figure_5_8,
    "fig-5-10": draw_figure_5_10,
    "fig-5-11": draw_figure_5_11,
    "fig-5-12": draw_figure_5_12,
    "fig-5-13": draw_figure_5_13,
}
"""Figure id -> function of plant, output folder and whether to be quick."""
