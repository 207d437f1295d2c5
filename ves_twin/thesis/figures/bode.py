"""draw_figure_5_2 and draw_figure_5_12: closed-loop Bode plots of the legs."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ves_twin.control.leg_loop import FilterPlace
from ves_twin.plant.hydraulics import Hydraulics
from ves_twin.plant.plant import Plant
from ves_twin.procedures.response.bode_plot import BodePlot
from ves_twin.procedures.response.frequency_response import actuator_slope
from ves_twin.procedures.response.sine_fit import MeasuredResponse
from ves_twin.procedures.response.sweep import SweepOptions, sweep_platform
from ves_twin.scenario.schema import Legs
from ves_twin.simulator.linear.leg_loop import leg_loop
from ves_twin.simulator.linear.leg_settings import LegSettings
from ves_twin.simulator.linear.response import (
    FrequencyResponse,
    bandwidth,
    frequency_response,
    resonance,
)
from ves_twin.thesis.figures.figure import FigureResult

FREQUENCIES = (0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 7.0, 10.0, 15.0, 20.0)
QUICK = (1.0, 5.0)
DENSE = np.geomspace(0.2, 40.0, 400)
COMPARED_UP_TO = 5.0
"""Linear and measured responses are compared up to here [Hz]."""
OLD_LEG_TICKS = 3
"""Leg cycle before the filter, 1.023 ms (thesis 5.3, errata E-4)."""
LOW, HIGH, GAINS, K2 = 12000, 20000, (3000, 6000, 12000, 20000, 30000), 30000
"""Counts of K1 and K2. 12000 is about 2 Hz without filter; the high gain of fig. 5-2 is assumed."""


def legs_of(settings: LegSettings) -> Legs:
    """The same settings as a scenario has them."""
    return Legs(gain=settings.gain, rate_gain=settings.rate_gain, filter=settings.place)


def other_form(plant: Plant) -> Plant:
    """The shipped plant with the other form of hydraulics."""
    return Plant.load("ves2_pressure" if plant.hydraulics is Hydraulics.LINEAR else "ves2")


def deviation(measured: MeasuredResponse, model: FrequencyResponse) -> tuple[float, float]:
    """Largest difference up to COMPARED_UP_TO in dB and deg."""
    low = measured.frequency <= COMPARED_UP_TO
    turn = np.degrees(np.angle(measured.gain / model.gain))
    return (
        float(np.max(np.abs(measured.decibel - model.decibel)[low])),
        float(np.max(np.abs(turn)[low])),
    )


def draw_figure_5_2(plant: Plant, folder: Path, quick: bool) -> FigureResult:
    """Closed loop without filter at low and high gain, at the leg cycle of that time."""
    ticks = {"clock.leg_ticks": OLD_LEG_TICKS}
    cases = {f"K1 = {k1}": LegSettings.of_counts(k1, 0, FilterPlace.NONE) for k1 in (LOW, HIGH)}
    plot = BodePlot(
        "Figure 5-2: closed loop without filter (lines: linear; o, x: simulation, both hydraulics)"
    )
    numbers: dict[str, float] = {}
    for n, (name, settings) in enumerate(cases.items()):
        _draw_case(plot, plant.with_values(ticks), name, settings, f"C{n}", quick, numbers)
    if not quick:
        low = LegSettings.of_counts(LOW, 0, FilterPlace.NONE)
        _draw_points(plot, other_form(plant).with_values(ticks), low, "C0", QUICK, numbers)
    plot.mark_bandwidth()
    plot.limit(-40.0, 10.0)
    png = plot.save(folder / "fig-5-2.png")
    note = f"the high gain is assumed: K1 = {HIGH}; leg cycle {OLD_LEG_TICKS} ticks"
    title = "Original closed loop response with high and low gains"
    return FigureResult("fig-5-2", title, png, numbers, (note,))


def draw_figure_5_12(plant: Plant, folder: Path, quick: bool) -> FigureResult:
    """Closed loop with the filter on the error, K2 = 30000, K1 from 3000 to 30000."""
    plot = BodePlot(
        "Figure 5-12: filter on the error, K2 = 30000 (lines: linear; o, x: simulation)"
    )
    numbers: dict[str, float] = {}
    for n, k1 in enumerate(GAINS):
        settings = LegSettings.of_counts(k1, K2, FilterPlace.ERROR)
        measured = k1 == HIGH or (not quick and k1 in (GAINS[0], GAINS[-1]))
        _draw_case(plot, plant, f"K1 = {k1}", settings, f"C{n}", quick, numbers, measured)
        bare = leg_loop(plant, LegSettings.of_counts(k1, 0, FilterPlace.ERROR))
        numbers[f"bandwidth K1 = {k1}, K2 = 0 [Hz]"] = bandwidth(bare)
    if not quick:
        default = LegSettings.of_counts(HIGH, K2, FilterPlace.ERROR)
        _draw_points(plot, other_form(plant), default, "C3", QUICK, numbers)
    plot.mark_bandwidth()
    plot.limit(-60.0, 10.0)
    png = plot.save(folder / "fig-5-12.png")
    title = "Bode plot of platform with filter, K2 = 30000, K1 = 3000 to 30000"
    note = "counts of K1 and K2 converted by assumed factors (errata E-48, E-49)"
    return FigureResult("fig-5-12", title, png, numbers, (note,))


def _draw_case(
    plot: BodePlot,
    plant: Plant,
    name: str,
    settings: LegSettings,
    colour: str,
    quick: bool,
    numbers: dict[str, float],
    measured: bool = True,
) -> None:
    loop = leg_loop(plant, settings)
    hertz = bandwidth(loop)
    plot.line(frequency_response(loop, DENSE), f"{name}: {hertz:.2f} Hz", colour)
    numbers[f"bandwidth {name} [Hz]"] = hertz
    numbers[f"resonance {name} [dB]"] = resonance(loop)
    if measured:
        _draw_points(plot, plant, settings, colour, QUICK if quick else FREQUENCIES, numbers, name)


def _draw_points(
    plot: BodePlot,
    plant: Plant,
    settings: LegSettings,
    colour: str,
    frequency: tuple[float, ...],
    numbers: dict[str, float],
    name: str = "",
) -> None:
    options = SweepOptions(periods=6)
    sweep = sweep_platform(plant, legs_of(settings), frequency, options)
    form = plant.hydraulics.value
    plot.points(sweep.legs, None, colour, "o" if name else "x")
    model = frequency_response(leg_loop(plant, settings), np.array(frequency))
    decibel, degrees = deviation(sweep.legs, model)
    case = f"{name or 'other form'}, {form} hydraulics"
    where = f"{case}, to {COMPARED_UP_TO:g} Hz"
    numbers[f"simulation against linear model, {where} [dB]"] = decibel
    numbers[f"simulation against linear model, {where} [deg]"] = degrees
    numbers[f"slope valve to length, {case} [dB/decade]"] = actuator_slope(plant, sweep)[0]
