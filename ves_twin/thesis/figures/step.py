"""draw_figure_5_13: step responses of the leg loop with filter."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ves_twin.control.leg_loop import FilterPlace
from ves_twin.plant.plant import Plant
from ves_twin.procedures.response.measured_step import measure_step
from ves_twin.report.figure import new_figure
from ves_twin.report.picture import PICTURE_WIDTH, save_picture
from ves_twin.simulator.linear.leg_loop import leg_loop
from ves_twin.simulator.linear.leg_settings import LegSettings
from ves_twin.simulator.linear.response import step_response
from ves_twin.thesis.figures.bode import GAINS, HIGH, K2, legs_of
from ves_twin.thesis.figures.figure import FigureResult

DURATION = 1.0


def draw_figure_5_13(plant: Plant, folder: Path, quick: bool) -> FigureResult:
    """Unit steps for K1 from 3000 to 30000, with K2 = 30000 (left) and without (right)."""
    figure = new_figure(4.0, PICTURE_WIDTH)
    numbers: dict[str, float] = {}
    for axes, k2 in zip(figure.subplots(1, 2, sharey=True), (K2, 0), strict=True):
        for n, k1 in enumerate(GAINS):
            settings = LegSettings.of_counts(k1, k2, FilterPlace.ERROR)
            model = step_response(leg_loop(plant, settings), DURATION)
            axes.plot(model.time, model.value, color=f"C{n}", lw=1.2, label=f"K1 = {k1}")
            name = f"K1 = {k1}, K2 = {k2}"
            numbers[f"overshoot {name} [%]"] = 100.0 * model.overshoot
            numbers[f"rise time {name} [s]"] = model.rise_time
            if k1 == HIGH or not quick:
                measured = measure_step(plant, legs_of(settings), DURATION)
                axes.plot(measured.time[::12], measured.value[::12], "o", color=f"C{n}", ms=3,
                          mfc="none")  # fmt: skip
                rows = min(len(measured.value), len(model.value))
                worst = np.max(np.abs(measured.value[:rows] - model.value[:rows]))
                numbers[f"simulation against linear model {name} [%]"] = 100.0 * float(worst)
        axes.set_title(f"K2 = {k2}", fontsize=10)
        axes.set_xlabel("time [s]")
        axes.grid(alpha=0.3)
    axes.legend(fontsize=7, loc="lower right")
    figure.suptitle("Figure 5-13: unit step, filter on the error (lines: linear, o: simulation)",
                    fontsize=10)  # fmt: skip
    png = save_picture(figure, folder / "fig-5-13.png")
    note = "the simulation's step is 2 mm of heave"
    return FigureResult(
        "fig-5-13", "Platform unit step response with filter", png, numbers, (note,)
    )
