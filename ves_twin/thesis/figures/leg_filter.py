"""draw_figure_5_3 and draw_figure_5_5: the leg filter, its rivals and its measurement."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ves_twin.control.leg_loop import FilterPlace
from ves_twin.plant.plant import Plant
from ves_twin.procedures.response.bode_plot import BodePlot
from ves_twin.procedures.response.sweep import SweepOptions, sweep_platform
from ves_twin.simulator.linear.filter_types import CORNER, basic_filters
from ves_twin.simulator.linear.leg_loop import section
from ves_twin.simulator.linear.leg_settings import LegSettings
from ves_twin.simulator.linear.response import frequency_response
from ves_twin.thesis.figures.bode import HIGH, legs_of
from ves_twin.thesis.figures.figure import FigureResult

DENSE = np.geomspace(0.5, 100.0, 500)
FREQUENCIES = (0.5, 1.0, 2.0, 5.0, 7.0, 9.0, 10.0, 11.0, 12.0, 13.0, 15.0, 20.0, 50.0, 100.0)
QUICK = (2.0, 9.0, 12.0, 15.0)


def draw_figure_5_3(plant: Plant, folder: Path, quick: bool) -> FigureResult:
    """Three basic filter types of second order at 10 Hz; nothing is measured."""
    plot = BodePlot(f"Figure 5-3: basic filter types, corner {CORNER:g} Hz")
    numbers: dict[str, float] = {}
    for n, (name, system) in enumerate(basic_filters(plant.parameters).items()):
        plot.line(frequency_response(system, DENSE), name, f"C{n}")
        low = frequency_response(system, np.array([5.0]))
        numbers[f"{name}: phase at 5 Hz [deg]"] = float(low.degrees[0])
        numbers[f"{name}: gain at 5 Hz [dB]"] = float(low.decibel[0])
    plot.limit(-50.0, 5.0)
    png = plot.save(folder / "fig-5-3.png")
    note = "the thesis does not name the three types; Butterworth, Chebyshev 1 (1 dB) and 2 (4 dB)"
    return FigureResult("fig-5-3", "Basic filter types", png, numbers, (note,))


def draw_figure_5_5(plant: Plant, folder: Path, quick: bool) -> FigureResult:
    """The filter as designed, and as measured through the running leg controllers."""
    frequency = QUICK if quick else FREQUENCIES
    settings = LegSettings.of_counts(HIGH, 0, FilterPlace.ERROR)
    sweep = sweep_platform(plant, legs_of(settings), frequency, SweepOptions(periods=6, held=True))
    system = section(plant.parameters)
    model = frequency_response(system, np.array(frequency))
    plot = BodePlot("Figure 5-5: leg filter, designed and measured with the platform held")
    plot.line(frequency_response(system, DENSE), "Table 5-1", "C0")
    plot.points(sweep.section, "through the running leg controllers", "C1")
    plot.limit(-50.0, 5.0)
    png = plot.save(folder / "fig-5-5.png")
    turn = np.degrees(np.angle(sweep.section.gain / model.gain))
    zero = system.zeros()[0]
    numbers = {
        "gain at rest": float(abs(system(1.0))),
        "notch [Hz]": float(abs(np.angle(zero)) / (2.0 * np.pi * system.dt)),
        "measured against designed [dB]": float(
            np.max(np.abs(sweep.section.decibel - model.decibel))
        ),
        "measured against designed [deg]": float(np.max(np.abs(turn))),
    }
    for hertz, gain, phase in zip(
        frequency, sweep.section.decibel, np.degrees(np.angle(sweep.section.gain)), strict=True
    ):
        numbers[f"measured at {hertz:g} Hz [dB]"] = float(gain)
        numbers[f"measured at {hertz:g} Hz [deg]"] = float(phase)
    title = "Experimental verification of open loop filter design"
    return FigureResult("fig-5-5", title, png, numbers, ("platform held: valves shut",))
