"""LearningMethod: W_g learned in slow motion and used at full speed, iteration by iteration."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from ves_twin.core.recording.recording import Recording
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.gravity.calibration import GravityCalibration
from ves_twin.plant.plant import Plant
from ves_twin.procedures.emulation.learning_phases import Changes, LearningPhases, poses_at_cycles
from ves_twin.procedures.emulation.learning_report import (
    Iteration,
    Learned,
    result_of,
    write_report,
)
from ves_twin.procedures.procedure import Procedure, Progress, Result, RunContext, part_of
from ves_twin.scenario.fields import Metres, Seconds, named, si
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.outcome import Outcome

FILE = "learned_gravity.parquet"


class Guess(StrEnum):
    """The motion that the first slow phase runs, Y^0."""

    NONE = "none"
    SIMULATED = "simulated"


class LearningMethod(Procedure):
    """Thesis 3.3: phase A records W_g in slow motion, phase B moves with it, again and again.

    `experiment` is a micro-gravity scenario; its gravity method is replaced. `guess`: no motion
    (the thesis), or that of a run of the belief, without noise and in `fast`. `noise_grade` and
    `drift_grade` scale the sensor's noise and the sd of its drift rates. `compare`: run the
    experiment also with gravity known exactly, which no laboratory can, to say what the method
    lost, and with the scenario's own gravity method. `settled_...` are the changes below which
    the motion counts as found (3.3.2).
    """

    experiment: str = "beam_model_method"
    duration: Annotated[Seconds, Field(gt=0, le=1e4)] | None = None
    alpha: Annotated[float, Field(gt=1, le=1000)] = 20.0
    iterations: Annotated[int, Field(ge=1, le=100)] = 9
    guess: Annotated[Guess, named("guess", [g.value for g in Guess])] = Guess.NONE
    smooth: Annotated[Seconds, Field(gt=0, le=10)] = 0.2
    noise_grade: Annotated[float, Field(ge=0, le=100)] = 1.0
    drift_grade: Annotated[float, Field(ge=0, le=100)] = 1.0
    compare: bool = True
    settled_translation: Annotated[Metres, Field(gt=0)] = 1e-3
    settled_rotation: Annotated[float, si("rad"), Field(gt=0)] = 1e-3
    seed: Annotated[int, Field(ge=0, lt=2**63)] = 0

    def carry_out(self, conduct: RunContext) -> Result:
        """Iterate; write `learned_gravity.parquet`, tables and pictures.

        An iteration that leaves the workspace ends it with that outcome; what was done is kept.

        Raises:
            InvalidInputError: an experiment whose commands are not known in advance, or that
                emulates nothing.
        """
        seed = self.seed if conduct.seed is None else conduct.seed
        phases = self.phases(conduct, seed)
        planned = phases.planned
        seeds = _seeds(seed, 2 * self.iterations + 2)
        parts = self.iterations + (1 if self.compare else 0)
        still = np.tile(np.array(phases.scenario.platform.start), (len(planned.commands), 1))
        motion = still if self.guess is Guess.NONE else self._simulated(phases)
        done: list[Iteration] = []
        outcome = Outcome.COMPLETED
        for number in range(self.iterations):
            progress = part_of(conduct.progress, number, parts)
            pair = seeds[2 * number], seeds[2 * number + 1]
            round_ = self._iteration(phases, motion, pair, conduct.folder / FILE, progress)
            outcome = round_.outcome
            if round_.iteration is None:
                break
            done.append(round_.iteration)
            motion = round_.iteration.motion
        exact = model = None
        if self.compare and outcome is Outcome.COMPLETED:
            last = part_of(conduct.progress, self.iterations, parts)
            ideal = replace(phases, plant=_with_ideal_sensor(phases.plant))
            exact = ideal.run(EXACT, seeds[-1], part_of(last, 0, 2), "gravity known exactly")
            own = {"gravity": self._own_gravity(phases.plant)}
            model = phases.run(own, seeds[-2], part_of(last, 1, 2), "the scenario's own method")
        learned = Learned(
            tuple(done),
            still[0],
            planned.period,
            (self.alpha + 1.0) * phases.scenario.run.duration,
            outcome,
            (self.settled_translation, self.settled_rotation),
            exact,
            model,
        )
        write_report(learned, conduct.folder)
        return result_of(learned)

    def phases(self, conduct: RunContext, seed: int) -> LearningPhases:
        """The experiment in the world that counts, with the grades of noise and drift.

        Raises:
            InvalidInputError: an experiment that cannot be learned.
        """
        changes: dict[str, object] = {"gravity": {"method": "none"}}
        if self.duration is not None:
            changes["run.duration"] = self.duration
        scenario = Scenario.load(self.experiment, changes)
        world = (conduct.plant or Plant.load(self.plant)).with_values(scenario.parameters)
        phases = LearningPhases(scenario, self._graded(world, seed), self.alpha, self.smooth)
        _ = phases.planned
        return phases

    def _own_gravity(self, plant: Plant) -> dict[str, Any]:
        """The scenario's gravity method; the belief's masses if its file is for another sensor."""
        gravity = Scenario.load(self.experiment).gravity
        own = gravity.model_dump(mode="json")
        if gravity.method == "model" and gravity.file is not None:
            fits = GravityCalibration.load(gravity.file).sensor == plant.sensor_identity
            own["file"] = gravity.file if fits else None
        return own

    def _graded(self, plant: Plant, seed: int) -> Plant:
        table = plant.parameters
        rates = np.random.default_rng(seed).normal(size=6) * table["sensor.drift"].sd
        noisy = {
            name: self.noise_grade * table.array(name) for name in ("sensor.noise", "sensor.wander")
        }
        drift = table.array("sensor.drift") + self.drift_grade * rates
        return plant.with_values({**noisy, "sensor.drift": drift})

    def _iteration(
        self,
        phases: LearningPhases,
        motion: FloatArray,
        seeds: tuple[int, int],
        file: Path,
        progress: Progress,
    ) -> _Round:
        slow = phases.slow(motion, seeds[0], part_of(progress, 0, 2))
        ended = Outcome(slow.info.outcome)
        if ended is not Outcome.COMPLETED:
            return _Round(None, ended)
        wrenches = phases.gravity(slow)
        source = f"{self.name}, seed {self.seed}, plant {phases.plant.name}"
        full = phases.full_speed(wrenches, file, source, seeds[1], part_of(progress, 1, 2))
        ended = Outcome(full.info.outcome)
        if ended is not Outcome.COMPLETED:
            return _Round(None, ended)
        moved = poses_at_cycles(full, phases.planned)
        return _Round(_iteration_of(phases, motion, moved, wrenches, slow, full), ended)

    def _simulated(self, phases: LearningPhases) -> FloatArray:
        """Y^0 by a run of the belief: its masses, its geometry, no noise, `fast`."""
        believed = Plant.load(phases.scenario.belief).with_fidelity("fast")
        guess = LearningPhases(phases.scenario, believed, self.alpha, self.smooth)
        changes: Changes = {"run": {"noise": False}, "gravity": {"method": "model"}}
        run = guess.run(changes, 0, lambda share, what: None)
        return poses_at_cycles(run, phases.planned)


EXACT: Changes = {"gravity": {"method": "truth", "file": None}, "run": {"noise": False}}


def _with_ideal_sensor(plant: Plant) -> Plant:
    """The plant with right gains: an exact estimate is no use to a sensor that shows another."""
    return plant.with_values({"sensor.crosstalk": np.zeros((6, 6))})


@dataclass(frozen=True)
class _Round:
    iteration: Iteration | None
    outcome: Outcome


def _iteration_of(
    phases: LearningPhases,
    asked: FloatArray,
    moved: FloatArray,
    wrenches: FloatArray,
    slow: Recording,
    full: Recording,
) -> Iteration:
    """What a laboratory can see of an iteration, and the motion beside the zero-g reference."""
    planned = phases.planned
    at = np.minimum(np.arange(len(moved)) * planned.period * phases.alpha, slow.time[-1])
    rows = np.searchsorted(slow.time, at + 0.25 * planned.period, "right") - 1
    return Iteration(
        motion=moved,
        change=moved - asked,
        wrenches=wrenches,
        path_error=slow["platform.pose"][rows] - asked,
        joint_error=slow["arm.q"][rows] - full["arm.q"][: len(rows)],
        run=full,
    )


def _seeds(seed: int, count: int) -> list[int]:
    """Seeds of the phases: each has noise of its own."""
    drawn = np.random.SeedSequence(seed).generate_state(count, np.uint64)
    return [int(one >> np.uint64(1)) for one in drawn]
