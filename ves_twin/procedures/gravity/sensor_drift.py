"""SensorDrift: eight hours of the force sensor alone, with and without zeroing in between."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from pydantic import Field, JsonValue

from ves_twin.core.types import FloatArray
from ves_twin.mechanics.gravity.sensitivity import AXES
from ves_twin.mechanics.kinematics.wrenches import top_to_sensor
from ves_twin.plant.plant import Plant
from ves_twin.procedures.procedure import Procedure, Result, RunContext
from ves_twin.report.picture import save_picture
from ves_twin.scenario.fields import Seconds
from ves_twin.simulator.outcome import Outcome
from ves_twin.simulator.sensor_run import sensor_run


class SensorDrift(Procedure):
    """Appendix F: the platform stands level, the arm is parked, the sensor is read for hours.

    Each axis drifts at a rate drawn with the sd that the plant's `sensor.drift` has (the thesis
    shows a serious drift, figs F-3 and F-4, whose numbers are lost). Zeroing takes the mean of
    `average` seconds off, every `zero_every` seconds.
    """

    duration: Annotated[Seconds, Field(ge=60, le=1e6)] = 28800.0
    zero_every: Annotated[Seconds, Field(ge=2, le=1e6)] = 600.0
    average: Annotated[Seconds, Field(ge=1, le=600)] = 10.0
    seed: Annotated[int, Field(ge=0, lt=2**63)] = 0

    def carry_out(self, conduct: RunContext) -> Result:
        """Run the sensor; write `drift.png`."""
        plant = conduct.plant or Plant.load(self.plant)
        seed = self.seed if conduct.seed is None else conduct.seed
        table = plant.parameters
        parked = np.array([[np.pi, np.pi / 2, 0.0]])
        in_top = plant.gravity_model.wrench_in_top(parked, np.zeros((1, 3)))[0]
        wrench = top_to_sensor(in_top, table.array("sensor.position"))
        rate = np.random.default_rng(seed).normal(size=6) * table["sensor.drift"].sd
        readings, means = sensor_run(table, wrench, int(self.duration), rate, seed)
        once = readings - np.mean(means[: int(self.average)], axis=0)
        often = self._zeroed(readings, means)
        conduct.progress(0.9, "picture")
        _picture(once, often, self.zero_every, conduct)
        return _account(once, often, self.zero_every)

    def _zeroed(self, readings: FloatArray, means: FloatArray) -> FloatArray:
        every, average = int(self.zero_every), int(self.average)
        result = readings.copy()
        for first in range(0, len(readings), every):
            zero = np.mean(means[first : first + average], axis=0)
            result[first : first + every] = readings[first : first + every] - zero
        return result


def _account(once: FloatArray, often: FloatArray, every: float) -> Result:
    rows = {
        "zeroed once: at the end": once[-60:].mean(axis=0),
        "  rms": _rms(once),
        f"zeroed every {every:g} s: rms": _rms(often),
        "  max": np.max(np.abs(often), axis=0),
    }
    lines = [f"  {'[N, N m]':<28}" + "".join(f"{axis:>9}" for axis in AXES)]
    lines += [f"  {name:<28}" + "".join(f"{v:9.3f}" for v in row) for name, row in rows.items()]
    values: dict[str, JsonValue] = {
        "zeroed_once_end": once[-60:].mean(axis=0).tolist(),
        "zeroed_once_rms": _rms(once).tolist(),
        "zeroed_often_rms": _rms(often).tolist(),
        "zeroed_often_max": np.max(np.abs(often), axis=0).tolist(),
    }
    return Result(Outcome.COMPLETED, values, tuple(lines))


def _rms(values: FloatArray) -> FloatArray:
    return np.asarray(np.sqrt(np.mean(values**2, axis=0)))


def _picture(once: FloatArray, often: FloatArray, every: float, conduct: RunContext) -> None:
    from matplotlib.backends.backend_agg import FigureCanvasAgg  # slow to import
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11.0, 6.0), layout="constrained")
    FigureCanvasAgg(figure)
    hours = np.arange(len(once)) / 3600.0
    heads = ("zeroed once", f"zeroed every {every / 60.0:g} min")
    grid = figure.subplots(2, 2, sharex=True, sharey="row")
    for column, (head, values) in enumerate(zip(heads, (once, often), strict=True)):
        for row, (first, unit) in enumerate(((0, "N"), (3, "N m"))):
            axes = grid[row, column]
            for i in range(first, first + 3):
                axes.plot(hours[::10], values[::10, i], lw=0.4, label=AXES[i])
            axes.set_ylabel(f"reading less weight [{unit}]")
            axes.grid(alpha=0.3)
            axes.legend(fontsize=8, loc="upper left")
        grid[0, column].set_title(head, fontsize=10)
        grid[1, column].set_xlabel("time [h]")
    save_picture(figure, conduct.folder / "drift.png")
