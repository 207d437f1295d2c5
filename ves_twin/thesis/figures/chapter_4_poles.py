"""draw_figure_4_4 and draw_figure_4_5: poles of arm and base with PPED and with high gains."""

from __future__ import annotations

from pathlib import Path

from ves_twin.mechanics.planning.flexible_base import HIGH_GAINS, PPED_GAINS, JointGains
from ves_twin.mechanics.planning.pped import damping_estimator
from ves_twin.plant.plant import Plant
from ves_twin.procedures.planning.pped_release import PpedRelease
from ves_twin.report.figure import new_figure
from ves_twin.report.picture import PICTURE_WIDTH, save_picture
from ves_twin.thesis.figures.chapter_4_shipped import shipped
from ves_twin.thesis.figures.figure import FigureResult


def draw_figure_4_4(plant: Plant, folder: Path, quick: bool) -> FigureResult:
    """The 18 poles with the PPED gains."""
    return _draw(plant, folder, "fig-4-4", "System poles, PPED gains", PPED_GAINS)


def draw_figure_4_5(plant: Plant, folder: Path, quick: bool) -> FigureResult:
    """The 18 poles with the high gains."""
    return _draw(plant, folder, "fig-4-5", "System poles, high gains", HIGH_GAINS)


def _draw(plant: Plant, folder: Path, name: str, title: str, gains: JointGains) -> FigureResult:
    procedure = shipped("pped_release", PpedRelease)
    poles = procedure.builder(plant, printed=True)(gains).poles()
    figure = new_figure(3.8, PICTURE_WIDTH)
    wide, near = figure.subplots(1, 2)
    for axes in (wide, near):
        axes.plot(poles.real, poles.imag, "x", color="C0", ms=7)
        axes.axhline(0.0, color="0.6", lw=0.8)
        axes.axvline(0.0, color="0.6", lw=0.8)
        axes.set_xlabel("real [1/s]")
        axes.grid(alpha=0.3)
    wide.set_ylabel("imaginary [1/s]")
    wide.set_title("all", fontsize=9)
    wide.set_xlim(-20, 2)
    wide.set_ylim(-32, 32)
    near.set_title("near the origin", fontsize=9)
    near.set_xlim(-0.8, 0.08)
    near.set_ylim(-5, 5)
    figure.suptitle(f"Figure {name[4:]}: {title[0].lower()}{title[1:]}", fontsize=10)
    numbers = {"damping estimator": damping_estimator(poles)}
    for k, pole in enumerate(poles[poles.imag >= 0], 1):
        numbers[f"pole {k}, real [1/s]"] = float(pole.real)
        numbers[f"pole {k}, imaginary [1/s]"] = float(pole.imag)
    png = save_picture(figure, folder / f"{name}.png")
    notes = ("printed inertias and base matrices, B46 = 0 (errata E-18, E-28)",)
    return FigureResult(name, title, png, numbers, notes)
