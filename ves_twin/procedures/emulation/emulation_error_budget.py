"""EmulationErrorBudget: the emulation error of the Model Method by source, with cross terms."""

from __future__ import annotations

import csv
from typing import Annotated

import numpy as np
from pydantic import Field, JsonValue

from ves_twin.core.types import FloatArray
from ves_twin.core.whole_file import whole_file
from ves_twin.plant.plant import Plant
from ves_twin.procedures.emulation.error_sources import GRAVITY_SOURCES, RIG_SOURCES, ErrorSources
from ves_twin.procedures.procedure import Procedure, Result, RunContext
from ves_twin.report.picture import save_picture
from ves_twin.scenario.fields import Seconds
from ves_twin.simulator.outcome import Outcome

AXES = ("x", "y", "z", "rx", "ry", "rz")


class EmulationErrorBudget(Procedure):
    """Thesis 3.5, with the ground truth that the laboratory never had: the zero-g reference.

    Each source is the difference between two runs that differ in it alone. Sources add up as
    motions over time, not as rms: two of them can cancel. What the run with everything on has
    beside their sum are the cross terms.
    """

    ideal: str = "ves2"
    experiment: str = "beam_model_method"
    duration: Annotated[Seconds, Field(gt=0, le=1e4)] = 20.0
    seed: Annotated[int, Field(ge=0, lt=2**63)] = 0

    def carry_out(self, conduct: RunContext) -> Result:
        """Run; write `budget.csv` and `budget.png`.

        Raises:
            VesTwinError: a run that ended early; says which source was on.
        """
        seed = self.seed if conduct.seed is None else conduct.seed
        sources = ErrorSources(
            scenario=self.experiment,
            changes={"run.duration": self.duration},
            real=conduct.plant or Plant.load(self.plant),
            ideal=Plant.load(self.ideal),
            seed=seed,
        )
        table = _table(sources.parts(conduct.progress))
        with (
            whole_file(conduct.folder / "budget.csv") as partial,
            partial.open("w", newline="", encoding="utf-8") as file,
        ):
            writer = csv.writer(file)
            units = ("m", "m", "m", "rad", "rad", "rad")
            writer.writerow(
                ["source", *(f"rms {a} [{u}]" for a, u in zip(AXES, units, strict=True))]
            )
            for name, row in table.items():
                writer.writerow([name, *(f"{v:.6g}" for v in row)])
        _picture(table, conduct)
        return _account(table)


def _table(parts: dict[str, FloatArray]) -> dict[str, FloatArray]:
    """Rms of each source, largest translation first, their sum, everything, cross terms (6,)."""
    rms = {name: _rms(parts[name]) for name in (*RIG_SOURCES, *GRAVITY_SOURCES)}
    ranked = sorted(rms, key=lambda name: -float(np.linalg.norm(rms[name][:3])))
    total = sum((parts[name] for name in rms), np.zeros_like(parts["everything"]))
    return {
        **{name: rms[name] for name in ranked},
        "sum of the sources": _rms(total),
        "everything on": _rms(parts["everything"]),
        "cross terms": _rms(parts["everything"] - total),
    }


def _rms(values: FloatArray) -> FloatArray:
    return np.asarray(np.sqrt(np.mean(values**2, axis=0)))


def _account(table: dict[str, FloatArray]) -> Result:
    lines = [f"  {'rms [mm, mrad]':<22}" + "".join(f"{axis:>9}" for axis in AXES) + f"{'|xyz|':>9}"]
    for name, row in table.items():
        if name == "sum of the sources":
            lines.append("")
        size = float(np.linalg.norm(row[:3]))
        lines.append(f"  {name:<22}" + "".join(f"{v * 1e3:9.3f}" for v in (*row, size)))
    first = next(iter(table))
    lines += ["", f"  the largest source is {first}; without it, at best, {_without(table):.2f} mm"]
    lines.append("  left: servo, oil, holds, and what the quick chain still delays")
    values: dict[str, JsonValue] = {
        "axes": list(AXES),
        "rms": {name: row.tolist() for name, row in table.items()},
        "ranked": [name for name in table if name in (*RIG_SOURCES, *GRAVITY_SOURCES)],
    }
    return Result(Outcome.COMPLETED, values, tuple(lines))


def _without(table: dict[str, FloatArray]) -> float:
    """Root of the sum of squares of all sources but the largest, translations [mm]."""
    sources = [row for name, row in table.items() if name in (*RIG_SOURCES, *GRAVITY_SOURCES)]
    return 1e3 * float(np.linalg.norm(np.concatenate([row[:3] for row in sources[1:]])))


def _picture(table: dict[str, FloatArray], conduct: RunContext) -> None:
    from matplotlib.backends.backend_agg import FigureCanvasAgg  # slow to import
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10.0, 3.6), layout="constrained")
    FigureCanvasAgg(figure)
    names = list(table)[::-1]
    places = np.arange(len(names))
    for axes, first, unit in zip(figure.subplots(1, 2, sharey=True), (0, 3), "mr", strict=True):
        for k in range(3):
            sizes = [table[name][first + k] * 1e3 for name in names]
            axes.barh(places + 0.27 * (1 - k), sizes, 0.25, label=AXES[first + k])
        axes.set_xlabel("rms [mm]" if unit == "m" else "rms [mrad]")
        axes.legend(fontsize=8)
        axes.grid(alpha=0.3, axis="x")
        axes.set_yticks(places, names)
    save_picture(figure, conduct.folder / "budget.png", 100)
