"""GravitySensitivity: what a wrong gravity estimate does to wrench and motion (figs 3-1, 3-2)."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from pydantic import Field, JsonValue

from ves_twin.core.recording.recording import Recording
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.kinematics.wrenches import sensor_to_top
from ves_twin.plant.plant import Plant
from ves_twin.procedures.gravity.gravity_shift import gravity_shift
from ves_twin.procedures.procedure import Procedure, Result, RunContext, part_of
from ves_twin.report.picture import save_picture
from ves_twin.scenario.fields import Seconds
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.outcome import Outcome
from ves_twin.simulator.simulate import simulate

HOW = ("suddenly", "at rest")


class GravitySensitivity(Procedure):
    """Thesis 3.2.1, 3.2.2: the experiment without noise, with each error of the estimate.

    Suddenly: the whole estimate is wrong from `sudden` on, as by a load that nobody knows of. At
    rest: it is wrong before the sensor is zeroed, which takes its share at the start pose off;
    what remains is the error of the change of gravity.
    """

    experiment: str = "beam_horizontal_truth"
    duration: Annotated[Seconds, Field(gt=0, le=1e4)] = 20.0
    errors: Annotated[tuple[float, ...], Field(min_length=1, max_length=20)] = (0.005, 0.01, 0.05)
    sudden: Annotated[Seconds, Field(ge=0)] = 0.0

    def carry_out(self, conduct: RunContext) -> Result:
        """Run; write `sensitivity.png`. A run that ends early is kept, with its outcome.

        Raises:
            VesTwinError: an experiment that cannot be built.
        """
        plant = conduct.plant or Plant.load(self.plant)
        parts = 1 + len(HOW) * len(self.errors)
        exact = self._run(plant, {})
        part_of(conduct.progress, 0, parts)(1.0, "exact estimate")
        runs: dict[tuple[str, float], Recording] = {}
        for how in HOW:
            for error in self.errors:
                since = self.sudden if how == "suddenly" else None
                change = {"gravity.error": error, "gravity.error_since": since}
                runs[how, error] = self._run(plant, change)
                part_of(conduct.progress, len(runs), parts)(1.0, f"{error:.1%} {how}")
        position = plant.parameters.array("sensor.position")
        _picture(exact, runs, position, conduct)
        return _account(exact, runs, position)

    def _run(self, plant: Plant, changes: dict[str, Any]) -> Recording:
        fixed = {"run.duration": self.duration, "run.noise": False}
        return simulate(Scenario.load(self.experiment, {**fixed, **changes}), plant)


def _account(
    exact: Recording, runs: dict[tuple[str, float], Recording], position: FloatArray
) -> Result:
    force = np.linalg.norm(_in_top(exact, "gravity.estimate", position)[:, :3], axis=1)
    weight, dynamic = float(np.max(force)), _peak(_dynamic(exact, position)[:, :3])
    lines = [
        f"  weight {weight:.0f} N, largest dynamic force {dynamic:.0f} N",
        "",
        f"  {'error of the estimate':<24}{'force':>9}{'Z peak':>11}{'Z shift':>11}"
        f"{'times true':>12}   ended",
    ]
    rows: list[JsonValue] = []
    for (how, error), run in runs.items():
        found, outcome = gravity_shift(exact, run), run.info.outcome
        when = "" if outcome == Outcome.COMPLETED else f" at {run.time[-1]:.1f} s"
        lines.append(
            f"  {f'{error:.1%} {how}':<24}{error * weight:7.1f} N{found.peak * 1e3:8.1f} mm"
            f"{found.shift * 1e3:8.1f} mm{found.ratio:12.2f}   {outcome}{when}"
        )
        rows.append(
            {
                "error": error,
                "how": how,
                "force": error * weight,
                "peak": found.peak,
                "shift": found.shift,
                "ratio": found.ratio,
                "outcome": outcome,
            }
        )
    values: dict[str, JsonValue] = {"weight": weight, "dynamic_force": dynamic, "runs": rows}
    return Result(Outcome(exact.info.outcome), values, tuple(lines))


def _in_top(run: Recording, name: str, position: FloatArray) -> FloatArray:
    return np.array([sensor_to_top(row, position) for row in run[name]])


def _dynamic(run: Recording, position: FloatArray) -> FloatArray:
    """Dynamic wrench, reading less estimate, in top axes [N, N m] (n, 6)."""
    return _in_top(run, "sensor.wrench", position) - _in_top(run, "gravity.estimate", position)


def _peak(vectors: FloatArray) -> float:
    return float(np.max(np.linalg.norm(vectors, axis=1)))


def _picture(
    exact: Recording,
    runs: dict[tuple[str, float], Recording],
    position: FloatArray,
    conduct: RunContext,
) -> None:
    from matplotlib.backends.backend_agg import FigureCanvasAgg  # slow to import
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11.0, 3.6), layout="constrained")
    FigureCanvasAgg(figure)
    left, middle, right = figure.subplots(1, 3)
    gravity = np.linalg.norm(_in_top(exact, "gravity.estimate", position)[:, :3], axis=1)
    dynamic = np.linalg.norm(_dynamic(exact, position)[:, :3], axis=1)
    shown = exact.time < 4.0  # the move and its echo
    for error, grey in zip(sorted({e for _, e in runs}, reverse=True)[:3], "864", strict=False):
        low, high = np.maximum(dynamic - error * gravity, 0.0), dynamic + error * gravity
        band = {"color": f"0.{grey}5", "label": f"{error:.1%} of gravity"}
        left.fill_between(exact.time[shown], low[shown], high[shown], lw=0, **band)
    left.plot(exact.time[shown], dynamic[shown], "k", lw=0.9, label="dynamic force")
    left.set_ylabel("force [N]")
    for axes, how in ((middle, "suddenly"), (right, "at rest")):
        axes.set_title(f"error {how}", fontsize=9)
        for (kind, error), run in runs.items():
            if kind == how:
                axes.plot(run.time, run["truth.pose"][:, 2] * 1e3, lw=0.9, label=f"{error:.1%}")
        axes.plot(exact.time, exact["truth.pose"][:, 2] * 1e3, "k", lw=1.0, label="exact")
        axes.set_ylabel("Z of the base [mm]")
    for axes in (left, middle, right):
        axes.set_xlabel("time [s]")
        axes.legend(fontsize=7)
        axes.grid(alpha=0.3)
    save_picture(figure, conduct.folder / "sensitivity.png", 100)
