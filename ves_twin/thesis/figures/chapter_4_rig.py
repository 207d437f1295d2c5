"""draw_figure_4_3 and the emulated release: chapter 4 on the rig."""

from __future__ import annotations

from pathlib import Path

from ves_twin.plant.plant import Plant
from ves_twin.procedures.planning.coupling_map_paths import CouplingMapPaths
from ves_twin.procedures.planning.pped_release_emulated import PpedReleaseEmulated
from ves_twin.report.figure import new_figure
from ves_twin.report.picture import PICTURE_WIDTH, save_picture
from ves_twin.thesis.figures.chapter_4_release import SHOWN, STYLES
from ves_twin.thesis.figures.chapter_4_shipped import shipped
from ves_twin.thesis.figures.figure import FigureResult

QUICK_REST, QUICK_RELEASE = 3.0, 10.0
"""Times of a quick drawing [s]: rest after a path, length of a release."""


def draw_figure_4_3(plant: Plant, folder: Path, quick: bool) -> FigureResult:
    """Energy along the good path on the rig, with the Model Method and without compensation."""
    procedure = shipped("coupling_map_paths", CouplingMapPaths)
    if quick:
        procedure = procedure.model_copy(update={"rest": QUICK_REST})
    runs = procedure.rig_runs(plant, bare=("good",))
    good, bare = runs.emulated["good"], runs.uncompensated["good"]
    figure = new_figure(3.8, PICTURE_WIDTH)
    axes = figure.subplots()
    floor = 1e-4  # of the picture [J]; the noise of the standing platform is below
    for run, colour, label in (
        (good, "C2", "good path, Model Method"),
        (runs.emulated["bad"], "C3", "bad path, Model Method"),
        (bare, "k", "good path, not compensated"),
    ):
        axes.semilogy(run.time, run.energy.clip(floor), color=colour, lw=1.2, label=label)
    axes.plot(bare.time[-1], bare.energy[-1], "kx", label=f"ends: {bare.outcome.value}")
    axes.set_xlabel("time [s]")
    axes.set_ylabel("energy in the beam [J]")
    axes.set_title("Figure 4-3: the sensor tared once, then left alone", fontsize=10)
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8, loc="lower right")
    png = save_picture(figure, folder / "fig-4-3.png")
    numbers = {
        "good, peak energy, not compensated [J]": bare.peak,
        "good, peak energy, Model Method [J]": good.peak,
        "not compensated over Model Method": bare.peak / good.peak,
        "end of the uncompensated run [s]": float(bare.time[-1]),
    }
    notes = (f"the uncompensated run ends by {bare.outcome.value}; logarithmic scale",)
    title = "Energy transferred to the flexible beam without gravity compensation"
    return FigureResult("fig-4-3", title, png, numbers, notes)


def draw_emulated_release(plant: Plant, folder: Path, quick: bool) -> FigureResult:
    """Figure 4-7 on the rig: energy after the release, beside leg lag alone and zero gravity."""
    procedure = shipped("pped_release_emulated", PpedReleaseEmulated)
    if quick:
        procedure = procedure.model_copy(update={"duration": QUICK_RELEASE})
    runs = {name: procedure.on_rig(plant, g) for name, g in procedure.gain_sets(plant).items()}
    figure = new_figure(7.6, PICTURE_WIDTH)
    numbers: dict[str, float] = {}
    heads = ("zero gravity", "leg lag alone", "on the rig, Model Method")
    panels = figure.subplots(3, 1, sharex=True, sharey=True)
    for axes, head, kind in zip(panels, heads, ("ideal", "leg_lag", "energy"), strict=True):
        for name, run in runs.items():
            colour, label = STYLES[name]
            shown = run.time < SHOWN
            curve = getattr(run, kind)[shown]
            axes.plot(run.time[shown], curve, color=colour, lw=1.2, label=label)
        axes.set_title(head, fontsize=10)
        axes.set_ylabel("strain energy [J]")
        axes.grid(alpha=0.3)
    for name, run in runs.items():
        for head, value in zip(("rig", "leg lag", "zero-g"), run.integrals(), strict=True):
            numbers[f"{name}, energy integral, {head} [J s]"] = value
    panels[0].legend(fontsize=8)
    panels[-1].set_xlabel("time [s]")
    png = save_picture(figure, folder / "fig-4-7-emulated.png")
    notes = ("not in the thesis, which left it undone; joints with their own friction",)
    title = "PPED release on the rig, energy"
    return FigureResult("fig-4-7-emulated", title, png, numbers, notes)
