"""draw_figure_5_8 and draw_figure_5_10: poles of the admittance loop with a light model."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ves_twin.control.leg_loop import FilterPlace
from ves_twin.core.types import ComplexArray
from ves_twin.plant.plant import Plant
from ves_twin.procedures.stability.measured_poles import measure_poles
from ves_twin.report.figure import new_figure
from ves_twin.report.picture import PICTURE_WIDTH, save_picture
from ves_twin.simulator.linear.admittance_loop import AxisModel, admittance_loop, payload_mass
from ves_twin.simulator.linear.leg_settings import LegSettings
from ves_twin.simulator.linear.stability_limit import stability_limit
from ves_twin.thesis.figures.bode import HIGH, legs_of, other_form
from ves_twin.thesis.figures.figure import FigureResult

RATE = 80.0
"""Admittance cycles [Hz]; becomes 79.3."""
RATIOS = (1.0, 0.8, 0.65, 0.5, 0.4, 0.3)
"""Model mass over payload mass along the locus; the last one is the low mass of the figure."""
LEFT, TOP = -60.0, 110.0
"""Corner of the picture [1/s]."""


def draw_figure_5_8(plant: Plant, folder: Path, quick: bool) -> FigureResult:
    """Filter on the error: two poles to the right for a model lighter than half the payload."""
    return _draw(plant, folder, quick, "fig-5-8", FilterPlace.ERROR)


def draw_figure_5_10(plant: Plant, folder: Path, quick: bool) -> FigureResult:
    """Filter on the feedback: the same models are stable."""
    return _draw(plant, folder, quick, "fig-5-10", FilterPlace.FEEDBACK)


def _draw(plant: Plant, folder: Path, quick: bool, name: str, place: FilterPlace) -> FigureResult:
    settings = LegSettings.of_counts(HIGH, 0, place)
    payload = payload_mass(plant)
    figure = new_figure(4.6, PICTURE_WIDTH)
    axes = figure.subplots()
    numbers = {"stability limit, model over payload mass": stability_limit(plant, settings, RATE)}
    for n, ratio in enumerate(RATIOS):
        loop = admittance_loop(plant, settings, AxisModel.trial(ratio * payload), RATE)
        poles = loop.poles()
        colour = str(0.75 - 0.15 * n) if ratio != RATIOS[-1] else "C0"
        axes.plot(poles.real, poles.imag, "x", color=colour, label=f"{ratio:g} of the payload")
    leading = _leading(poles)
    numbers["leading pole, linear, real [1/s]"] = float(leading.real)
    numbers["leading pole, linear, frequency [Hz]"] = float(leading.imag / (2.0 * np.pi))
    model = AxisModel.trial(RATIOS[-1] * payload)
    for n, world in enumerate([plant] if quick else [plant, other_form(plant)]):
        form = world.hydraulics.value
        found = measure_poles(world, legs_of(settings), model, RATE)
        strongest = np.array([found[0], np.conj(found[0])])
        strongest = strongest[np.argsort(-strongest.imag)]
        axes.plot(strongest.real, strongest.imag, "os"[n], color=f"C{n + 1}", mfc="none", ms=9,
                  label=f"simulation, {form}, {RATIOS[-1]:g}")  # fmt: skip
        numbers[f"strongest pole, simulation, {form}, real [1/s]"] = float(strongest[0].real)
        numbers[f"strongest pole, simulation, {form}, frequency [Hz]"] = float(
            strongest[0].imag / (2.0 * np.pi)
        )
    axes.axvline(0.0, color="0.3", lw=0.8)
    axes.set_xlim(LEFT, 15.0)
    axes.set_ylim(-TOP, TOP)
    axes.set_xlabel("real part [1/s]")
    axes.set_ylabel("imaginary part [rad/s]")
    axes.grid(alpha=0.3)
    axes.legend(fontsize=7, loc="center left")
    axes.set_title(f"Figure {name[4:]}: poles in heave, filter on {place.value}", fontsize=10)
    png = save_picture(figure, folder / f"{name}.png")
    note = "model of 0.3 Hz and 5 % damping, K2 = 0; of the simulation the strongest pole"
    title = f"VES pole plot, filter on {place.value} signal"
    return FigureResult(name, title, png, numbers, (note,))


def _leading(poles: ComplexArray) -> complex:
    """The pole of the upper half plane that grows fastest, or decays slowest."""
    upper = poles[poles.imag >= 0.0]
    return complex(upper[np.argmax(upper.real)])
