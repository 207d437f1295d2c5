"""MethodsAgreement: Learning less Model Method beside what their two error budgets predict."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Any

import numpy as np
from pydantic import Field, JsonValue

from ves_twin.core.types import FloatArray
from ves_twin.plant.plant import Plant
from ves_twin.procedures.emulation.error_sources import GRAVITY_SOURCES, ErrorSources
from ves_twin.procedures.emulation.learning_method import Guess, LearningMethod
from ves_twin.procedures.emulation.learning_report import AXES
from ves_twin.procedures.number_table import write_table
from ves_twin.procedures.procedure import Procedure, Progress, Result, RunContext, part_of
from ves_twin.scenario.fields import Seconds
from ves_twin.simulator.outcome import Outcome

LOST = "lost_against_gravity_known_exactly"
LEVEL = "platform.level"


class MethodsAgreement(Procedure):
    """Thesis 3.5, figs 3-7 and 3-8: do both methods differ by no more than their errors say?

    Both methods run once on one rig: sensor with its gains, noise and drift, base off the level.
    Beside the difference of the two motions stand the two error budgets, from runs with *other*
    draws of noise, drift and level, one source at a time; what both methods share, the legs, the
    delays and the structure, is in neither. A budget is the root of the sum of mean squares of its
    sources over `draws`; the prediction is the root of the sum of squares of both.

    `ideal` is the rig with a sensor whose gains are right. The Learning Method starts from a
    motion simulated with the belief, so that `iterations` may be few.
    """

    ideal: str = "ves2_fast"
    experiment: str = "beam_model_method"
    duration: Annotated[Seconds, Field(gt=0, le=1e4)] = 20.0
    alpha: Annotated[float, Field(gt=1, le=1000)] = 20.0
    iterations: Annotated[int, Field(ge=1, le=100)] = 2
    draws: Annotated[int, Field(ge=1, le=100)] = 2
    seed: Annotated[int, Field(ge=0, lt=2**62)] = 0

    def carry_out(self, conduct: RunContext) -> Result:
        """Run; write `agreement.csv`, and what the Learning Method writes.

        Raises:
            VesTwinError: an experiment that cannot be learned, or a run that ended early.
        """
        seed = self.seed if conduct.seed is None else conduct.seed
        real, ideal = conduct.plant or Plant.load(self.plant), Plant.load(self.ideal)
        parts = 1 + 2 * self.draws
        both = self._learning(seed, 1.0, 1.0).carry_out(
            RunContext(
                conduct.folder, _tilted(real, seed), None, part_of(conduct.progress, 0, parts)
            )
        )
        if both.outcome is not Outcome.COMPLETED:
            return both
        difference = np.array(both.values["Learning_less_Model_Method"])
        squares: dict[str, list[dict[str, FloatArray]]] = {"Learning": [], "Model": []}
        for draw in range(1, self.draws + 1):
            at = [part_of(conduct.progress, 2 * draw - k, parts) for k in (1, 0)]
            squares["Learning"].append(self._learning_budget(real, ideal, seed + draw, at[0]))
            squares["Model"].append(self._model_budget(real, ideal, seed + draw, at[1]))
        budgets = {
            method: {name: np.mean([one[name] for one in found], axis=0) for name in found[0]}
            for method, found in squares.items()
        }
        table = agreement(difference, budgets)
        write_table(conduct.folder / "agreement.csv", {"axis": np.arange(1.0, 7.0), **table})
        return _account(table)

    def _learning(self, seed: int, noise: float, drift: float) -> LearningMethod:
        return LearningMethod(
            name=self.name,
            question=self.question,
            procedure="learning_method",
            experiment=self.experiment,
            duration=self.duration,
            alpha=self.alpha,
            iterations=self.iterations,
            guess=Guess.SIMULATED,
            noise_grade=noise,
            drift_grade=drift,
            seed=seed,
        )

    def _learning_budget(
        self, real: Plant, ideal: Plant, seed: int, progress: Progress
    ) -> dict[str, FloatArray]:
        """Mean squares by source (6,), each less those of `rest`.

        `rest` is what all runs have: phase A off its path, smoothing, transducers, iterations that
        are not over.
        """
        plans: dict[str, tuple[Plant, float, float]] = {
            "rest": (ideal, 0.0, 0.0),
            "sensor noise": (ideal, 1.0, 0.0),
            "drift": (ideal, 0.0, 1.0),
            "gains and level": (_tilted(real, seed), 0.0, 0.0),
        }
        squares: dict[str, FloatArray] = {}
        for number, (name, (plant, noise, drift)) in enumerate(plans.items()):
            values = self._lost(plant, seed, (noise, drift), part_of(progress, number, len(plans)))
            squares[name] = np.square(np.array(values))
        rest = squares["rest"]
        return {
            name: rest if name == "rest" else np.maximum(square - rest, 0.0)
            for name, square in squares.items()
        }

    def _lost(
        self, plant: Plant, seed: int, grades: tuple[float, float], progress: Progress
    ) -> Any:
        with TemporaryDirectory() as folder:
            conduct = RunContext(Path(folder), plant, None, progress)
            return self._learning(seed, *grades).carry_out(conduct).values.get(LOST, [np.nan] * 6)

    def _model_budget(
        self, real: Plant, ideal: Plant, seed: int, progress: Progress
    ) -> dict[str, FloatArray]:
        """Mean squares by source (6,)."""
        changes = {"run.duration": self.duration}
        sources = ErrorSources(self.experiment, changes, real, ideal, seed)
        parts = sources.gravity_parts(progress)
        return {name: np.mean(parts[name] ** 2, axis=0) for name in GRAVITY_SOURCES}


def agreement(
    difference: FloatArray, budgets: dict[str, dict[str, FloatArray]]
) -> dict[str, FloatArray]:
    """Rms by axis: each source, each budget, both, the difference, and its ratio to both (6,).

    Args:
        difference: rms of one motion less the other [m, rad] (6,).
        budgets: method -> source -> mean square [m^2, rad^2] (6,).
    """
    table: dict[str, FloatArray] = {}
    total = np.zeros(6)
    for method, sources in budgets.items():
        table |= {f"{method}: {name}": np.sqrt(square) for name, square in sources.items()}
        square = np.sum(list(sources.values()), axis=0)
        table[f"{method}: budget"] = np.sqrt(square)
        total = total + square
    both = np.sqrt(total)
    return {
        **table,
        "both budgets": both,
        "Learning less Model Method": difference,
        "ratio": difference / both,
    }


def _tilted(plant: Plant, seed: int) -> Plant:
    """The plant with its base off the level by a draw of the sd that commissioning leaves."""
    level = plant.parameters[LEVEL]
    drawn = level.sd * np.random.default_rng([seed, 1]).normal(size=level.value.shape)
    return plant.with_values({LEVEL: level.value + drawn})


def _account(table: dict[str, FloatArray]) -> Result:
    lines = [f"  {'rms [mm, mrad]':<30}" + "".join(f"{axis:>9}" for axis in AXES)]
    for name, row in table.items():
        scale = 1.0 if name == "ratio" else 1e3
        lines.append(f"  {name:<30}" + "".join(f"{v * scale:9.3f}" for v in row))
    over = [axis for axis, ratio in zip(AXES, table["ratio"], strict=True) if not ratio <= 1.0]
    lines += ["", f"  more than both budgets predict: {', '.join(over) or 'on no axis'}"]
    values: dict[str, JsonValue] = {
        "axes": list(AXES),
        "rms": {name: row.tolist() for name, row in table.items() if name != "ratio"},
        "ratio": table["ratio"].tolist(),
        "within": [axis not in over for axis in AXES],
    }
    return Result(Outcome.COMPLETED, values, tuple(lines))
