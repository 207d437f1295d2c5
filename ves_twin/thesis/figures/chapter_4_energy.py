"""draw_figure_4_2: energy transferred to the flexible beam along the paths, zero-g and rig."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ves_twin.plant.plant import Plant
from ves_twin.procedures.planning.coupling_map_paths import CYCLE, CouplingMapPaths, peak_ratio
from ves_twin.report.figure import new_figure
from ves_twin.report.picture import PICTURE_WIDTH, save_picture
from ves_twin.thesis.figures.chapter_4_map import STYLES
from ves_twin.thesis.figures.chapter_4_shipped import shipped
from ves_twin.thesis.figures.figure import FigureResult


def draw_figure_4_2(plant: Plant, folder: Path, quick: bool) -> FigureResult:
    """Strain energy of the base over time, one line a path."""
    procedure = shipped("coupling_map_paths", CouplingMapPaths)
    if quick:
        procedure = procedure.model_copy(update={"rest": 3.0})
    figure = new_figure(3.8, PICTURE_WIDTH)
    axes = figure.subplots()
    numbers: dict[str, float] = {}
    ideal, rig = procedure.runs(plant), procedure.rig_runs(plant, bare=()).emulated
    for name, run in ideal.items():
        colour, label = STYLES[name]
        axes.plot(rig[name].time, rig[name].energy, color=colour, lw=1.3, label=label)
        time = CYCLE * np.arange(len(run.energy))
        axes.plot(time, run.energy, "--", color=colour, lw=0.9, label=f"{label}, zero gravity")
        numbers[f"{name}, peak energy on the rig [J]"] = rig[name].peak
        numbers[f"{name}, peak energy [J]"] = float(run.energy.max())
        numbers[f"{name}, coupling crossed"] = run.coupling
    numbers["good over bad, peak energy"] = peak_ratio(ideal)
    numbers["good over bad on the rig, peak energy"] = rig["good"].peak / rig["bad"].peak
    axes.axvline(procedure.duration, color="0.7", lw=0.8)
    axes.set_xlabel("time [s]")
    axes.set_ylabel("energy in the beam [J]")
    axes.set_title(
        f"Figure 4-2: rig with the Model Method, {procedure.duration:g} s each", fontsize=10
    )
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8)
    png = save_picture(figure, folder / "fig-4-2.png")
    notes = ("start and end are a choice: those of the thesis are lost",)
    title = "Energy transferred to the flexible beam for two motions"
    return FigureResult("fig-4-2", title, png, numbers, notes)
