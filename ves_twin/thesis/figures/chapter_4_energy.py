"""draw_figure_4_2: energy transferred to the flexible beam along the paths, in zero gravity."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ves_twin.plant.plant import Plant
from ves_twin.procedures.coupling_map_paths import CYCLE, CouplingMapPaths
from ves_twin.thesis.figures.canvas import new_canvas, save_canvas
from ves_twin.thesis.figures.chapter_4_map import STYLES
from ves_twin.thesis.figures.chapter_4_shipped import shipped
from ves_twin.thesis.figures.figure import FigureResult


def draw_figure_4_2(plant: Plant, folder: Path, quick: bool) -> FigureResult:
    """Strain energy of the base over time, one line a path."""
    procedure = shipped("coupling_map_paths", CouplingMapPaths)
    if quick:
        procedure = procedure.model_copy(update={"rest": 5.0})
    figure = new_canvas(7.0, 3.8)
    axes = figure.subplots()
    numbers: dict[str, float] = {}
    peaks = {}
    for name, run in procedure.runs(plant).items():
        colour, label = STYLES[name]
        axes.plot(CYCLE * np.arange(len(run.energy)), run.energy, color=colour, lw=1.3, label=label)
        peaks[name] = float(run.energy.max())
        numbers[f"{name}, peak energy [J]"] = peaks[name]
        numbers[f"{name}, coupling crossed"] = run.coupling
    numbers["good over bad, peak energy"] = peaks["good"] / peaks["bad"]
    axes.axvline(procedure.duration, color="0.7", lw=0.8)
    axes.set_xlabel("time [s]")
    axes.set_ylabel("energy in the beam [J]")
    axes.set_title(
        f"Figure 4-2 in zero gravity: the same ends, {procedure.duration:g} s each", fontsize=10
    )
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8)
    png = save_canvas(figure, folder / "fig-4-2.png")
    notes = ("zero-g reference; the thesis measured it on the rig with the Model Method",)
    title = "Energy transferred to the flexible beam for two motions"
    return FigureResult("fig-4-2", title, png, numbers, notes)
