"""draw_figure_4_6 and draw_figure_4_7: translation and energy of the base after a release."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.mechanics.planning.flexible_base import HIGH_GAINS, PPED_GAINS
from ves_twin.plant.plant import Plant
from ves_twin.procedures.planning.pped_release import CYCLE, PpedRelease, Release
from ves_twin.report.figure import new_figure
from ves_twin.report.picture import PICTURE_WIDTH, save_picture
from ves_twin.thesis.figures.chapter_4_shipped import shipped
from ves_twin.thesis.figures.figure import FigureResult

SHOWN = 20.0
"""Length of the picture [s]; the integrals go over the whole release."""

STYLES = {
    "pped": ("C2", "PPED gains (4.5)"),
    "high": ("C3", "high gains (4.6)"),
    "energy": ("C0", "gains of least energy, found here"),
}


def draw_figure_4_6(plant: Plant, folder: Path, quick: bool) -> FigureResult:
    """Translation of the base over time."""
    return _draw(
        plant,
        folder,
        "fig-4-6",
        "PPED simulation results, translation",
        "translation of the base [m]",
        lambda release: np.asarray(np.linalg.norm(release.pose[:, :3], axis=1)),
    )


def draw_figure_4_7(plant: Plant, folder: Path, quick: bool) -> FigureResult:
    """Strain energy of the base over time."""
    return _draw(
        plant,
        folder,
        "fig-4-7",
        "PPED simulation results, energy",
        "strain energy [J]",
        lambda release: release.energy,
    )


def _draw(
    plant: Plant,
    folder: Path,
    name: str,
    title: str,
    what: str,
    value: Callable[[Release], FloatArray],
) -> FigureResult:
    procedure = shipped("pped_release", PpedRelease)
    sets = {"pped": PPED_GAINS, "high": HIGH_GAINS, "energy": procedure.least_energy(plant)}
    figure = new_figure(3.8, PICTURE_WIDTH)
    axes = figure.subplots()
    numbers: dict[str, float] = {}
    for kind, (colour, label) in STYLES.items():
        release = procedure.release(plant, sets[kind])
        rows = round(SHOWN / CYCLE)
        curve = value(release)
        axes.plot(CYCLE * np.arange(rows), curve[:rows], color=colour, lw=1.2, label=label)
        early = (round(4.0 / CYCLE), round(6.0 / CYCLE))
        numbers[f"{kind}, energy integral to {procedure.duration:g} s [J s]"] = release.integral
        numbers[f"{kind}, mean of the curve, 4 to 6 s"] = float(np.mean(curve[slice(*early)]))
    axes.set_xlabel("time [s]")
    axes.set_ylabel(what)
    axes.set_title(f"Figure {name[4:]}: release from (0.1, 0.1, 0.1) m", fontsize=10)
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8)
    png = save_picture(figure, folder / f"{name}.png")
    notes = ("linear dynamics with the printed inertias; the third curve is not in the thesis",)
    return FigureResult(name, title, png, numbers, notes)
