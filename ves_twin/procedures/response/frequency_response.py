"""FrequencyResponseTest: sines of the platform in Z, beside the linear model of the leg loop."""

from __future__ import annotations

from typing import Annotated, Literal, final

import numpy as np
from pydantic import Field, JsonValue

from ves_twin.plant.plant import Plant
from ves_twin.procedures.procedure import Procedure, Result, RunContext
from ves_twin.procedures.response.bode_plot import BodePlot
from ves_twin.procedures.response.sine_fit import MeasuredResponse
from ves_twin.procedures.response.sweep import Sweep, SweepOptions, sweep_platform
from ves_twin.scenario.fields import Hertz, Metres
from ves_twin.scenario.schema import Legs
from ves_twin.simulator.linear.leg_loop import leg_actuator, leg_loop, section
from ves_twin.simulator.linear.leg_settings import LegSettings
from ves_twin.simulator.linear.response import FrequencyResponse, bandwidth, frequency_response
from ves_twin.simulator.outcome import Outcome

PICTURE = "frequency_response.png"


def settings_of(legs: Legs) -> LegSettings:
    """The leg settings of a scenario, for the linear models."""
    return LegSettings(legs.gain, legs.rate_gain, legs.filter)


@final
class FrequencyResponseTest(Procedure):
    """One sweep, closed loop or with the platform held (thesis 5.3).

    Closed loop, what counts is measured over commanded length. Held, the valves are shut, the
    lengths stand, and the running leg controller is seen from command to valve: its section.
    """

    procedure: Literal["frequency_response"]
    legs: Legs
    frequency: Annotated[tuple[Hertz, ...], Field(min_length=1)]
    amplitude: Annotated[Metres, Field(gt=0, le=0.05)] = 0.002
    rate: Annotated[Hertz, Field(ge=1, le=1000)] | None = None
    periods: Annotated[int, Field(ge=3, le=1000)] = 12
    held: bool = False

    def carry_out(self, conduct: RunContext) -> Result:
        """Sweep, compare with the linear model, draw."""
        plant = conduct.plant or Plant.load(self.plant)
        options = SweepOptions(self.amplitude, self.rate, self.periods, self.held)
        sweep = sweep_platform(plant, self.legs, self.frequency, options, conduct.progress)
        measured, model = self._pair(plant, sweep)
        name = "section, held" if self.held else "measured over commanded length"
        plot = BodePlot(f"{self.name}: {name} (line: linear model)")
        dense = np.geomspace(min(self.frequency) / 1.5, max(self.frequency) * 1.2, 300)
        plot.line(self._model(plant, dense), "linear model", "C0")
        plot.points(measured, "full simulation", "C1")
        plot.save(conduct.folder / PICTURE)
        return Result(
            Outcome.COMPLETED, self._values(plant, measured, model), _table(measured, model)
        )

    def _pair(self, plant: Plant, sweep: Sweep) -> tuple[MeasuredResponse, FrequencyResponse]:
        measured = sweep.section if self.held else sweep.legs
        return measured, self._model(plant, measured.frequency)

    def _model(self, plant: Plant, frequency: np.ndarray) -> FrequencyResponse:
        if self.held:
            return frequency_response(section(plant.parameters), frequency)
        return frequency_response(leg_loop(plant, settings_of(self.legs)), frequency)

    def _values(
        self, plant: Plant, measured: MeasuredResponse, model: FrequencyResponse
    ) -> dict[str, JsonValue]:
        values: dict[str, JsonValue] = {
            "plant_hash": plant.hash,
            "frequency": measured.frequency.tolist(),
            "decibel": measured.decibel.tolist(),
            "degrees": measured.degrees.tolist(),
            "relative_error": measured.error.tolist(),
            "model_decibel": model.decibel.tolist(),
            "model_degrees": model.degrees.tolist(),
        }
        if not self.held:
            values["model_bandwidth"] = bandwidth(leg_loop(plant, settings_of(self.legs)))
        return values


def actuator_slope(plant: Plant, sweep: Sweep) -> tuple[float, float]:
    """Slope of valve to length, measured and of the linear model [dB/decade]."""
    model = frequency_response(leg_actuator(plant), sweep.actuator.frequency)
    decades = np.log10(sweep.actuator.frequency)
    measured, linear = (
        float(np.polyfit(decades, response.decibel, 1)[0]) for response in (sweep.actuator, model)
    )
    return measured, linear


def _table(measured: MeasuredResponse, model: FrequencyResponse) -> tuple[str, ...]:
    head = f"  {'Hz':>7} {'dB':>8} {'deg':>8}   {'model dB':>8} {'deg':>8}   {'+- %':>7}"
    columns = (
        measured.frequency,
        measured.decibel,
        measured.degrees,
        model.decibel,
        model.degrees,
        100.0 * measured.error,
    )
    rows = [
        f"  {f:7.2f} {g:8.2f} {p:8.1f}   {mg:8.2f} {mp:8.1f}   {e:7.3f}"
        for f, g, p, mg, mp, e in zip(*columns, strict=True)
    ]
    return (head, *rows)
