"""PpedReleaseEmulated: the release of chapter 4 on the rig, which the thesis left undone."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from pydantic import Field, JsonValue

from ves_twin.core.types import FloatArray
from ves_twin.mechanics.emulated import EmulatedSystem
from ves_twin.mechanics.planning.flexible_base import (
    HIGH_GAINS,
    PPED_GAINS,
    FlexibleBaseArm,
    JointGains,
)
from ves_twin.mechanics.planning.lagging_base import LaggingBaseArm
from ves_twin.mechanics.planning.pped import strain_energy_integral
from ves_twin.plant.plant import Plant
from ves_twin.plant.puma_chain import puma_chain
from ves_twin.procedures.number_table import write_table
from ves_twin.procedures.planning.pped_release import PpedRelease
from ves_twin.procedures.planning.rig_energy import RigEnergy, RigOptions
from ves_twin.procedures.procedure import Result, RunContext
from ves_twin.simulator.outcome import Outcome


@dataclass(frozen=True)
class Prediction:
    """Energy integrals [J s] by linear dynamics, split inertias: ideal base, base behind legs."""

    ideal: float
    leg_lag: float


class PpedReleaseEmulated(PpedRelease):
    """PPED, high and optimised joint gains on the rig under the Model Method.

    The joint servo takes the gains in place of its own and has no integrator. On the rig the arm
    weighs something, so the computers feed forward the torque that the believed weight needs.
    `parameters` changes the plant.
    """

    parameters: dict[str, Any] = Field(default_factory=dict)
    rig: RigOptions = RigOptions()

    def gain_sets(self, plant: Plant) -> dict[str, JointGains]:
        """The gains that are tried, by name."""
        return {"pped": PPED_GAINS, "high": HIGH_GAINS, "energy": self.least_energy(plant)}

    def on_rig(self, plant: Plant, gains: JointGains, seed: int | None = None) -> RigEnergy:
        """One release on the rig."""
        changes: dict[str, object] = {
            "servo.stiffness": gains.stiffness.tolist(),
            "servo.damping": gains.damping.tolist(),
            "servo.integral": [0.0] * 3,
        }
        if not self.friction:
            changes["arm.damping"] = [0.0] * 3
        arm = {"start": self.q, "gravity_feedforward": True}
        return self.rig.run(
            plant, seed, self.emulated, self.duration, arm, self.start, parameters=changes
        )

    def prediction(self, plant: Plant, gains: JointGains | None) -> Prediction:
        """The linear figures for the same release; gains None: joints locked."""
        base, start = EmulatedSystem.load(self.emulated), np.array(self.start)
        mass = puma_chain(plant).mass_matrix(np.array(self.q))
        friction = plant.parameters.array("arm.damping") if self.friction else np.zeros(3)
        if gains is None:
            mass, held = mass[:6, :6], JointGains(np.zeros(0), np.zeros(0))
        else:
            held = JointGains(gains.stiffness, gains.damping + friction)
        lag = float(np.median(plant.actual.array("hydraulics.valve_lag")))
        behind = LaggingBaseArm(mass, base, held, self.rig.legs_gain, lag)
        return Prediction(
            strain_energy_integral(FlexibleBaseArm.of(mass, base, held), start, self.duration),
            behind.energy_integral(start, self.duration),
        )

    def carry_out(self, conduct: RunContext) -> Result:
        """Search, release on the rig, write `release_emulated.csv` with energies over time.

        Raises:
            VesTwinError: a base or a pose that cannot be.
        """
        plant = (conduct.plant or Plant.load(self.plant)).with_values(self.parameters)
        conduct.progress(0.0, "gain search")
        sets = self.gain_sets(plant)
        runs: dict[str, RigEnergy] = {}
        for k, (name, gains) in enumerate(sets.items(), 1):
            conduct.progress(k / (len(sets) + 1), f"release on the rig, {name}")
            runs[name] = self.on_rig(plant, gains, conduct.seed)
        predictions = {name: self.prediction(plant, gains) for name, gains in sets.items()}
        locked = self.prediction(plant, None)
        shortest = min(len(run.time) for run in runs.values())
        columns: dict[str, FloatArray] = {"t [s]": runs["pped"].time[:shortest]}
        for name, run in runs.items():
            columns[f"{name}.rig [J]"] = run.energy[:shortest]
            columns[f"{name}.leg_lag [J]"] = run.leg_lag[:shortest]
            columns[f"{name}.ideal [J]"] = run.ideal[:shortest]
        write_table(conduct.folder / "release_emulated.csv", columns)
        conduct.progress(1.0, "written")
        whole = all(run.outcome is Outcome.COMPLETED for run in runs.values())
        outcome = (
            Outcome.COMPLETED
            if whole
            else next(run.outcome for run in runs.values() if run.outcome is not Outcome.COMPLETED)
        )
        values: dict[str, JsonValue] = {
            name: _figures(sets[name], runs[name], predictions[name]) for name in sets
        }
        values["locked"] = {"linear_ideal": locked.ideal, "linear_leg_lag": locked.leg_lag}
        values["less_than_pped"] = _shares(runs, predictions, "energy", "pped")
        values["pped_less_than_high"] = _shares(runs, predictions, "pped", "high")
        return Result(outcome, {"emulated": values}, _lines(values, tuple(sets)))


def _figures(gains: JointGains, run: RigEnergy, linear: Prediction) -> dict[str, JsonValue]:
    rig, lag, ideal = run.integrals()
    return {
        "stiffness": gains.stiffness.tolist(),
        "damping": gains.damping.tolist(),
        "outcome": run.outcome.value,
        "rig": rig,
        "leg_lag": lag,
        "ideal": ideal,
        "linear_leg_lag": linear.leg_lag,
        "linear_ideal": linear.ideal,
        "joint_peak": run.joint_peak.tolist(),
    }


def _shares(
    runs: dict[str, RigEnergy], linear: dict[str, Prediction], one: str, other: str
) -> dict[str, JsonValue]:
    """How much less energy one set of gains leaves than another, as shares."""
    pairs = zip(runs[one].integrals(), runs[other].integrals(), strict=True)
    rig, lag, ideal = (1.0 - a / b for a, b in pairs)
    return {
        "rig": rig,
        "leg_lag": lag,
        "ideal": ideal,
        "linear_leg_lag": 1.0 - linear[one].leg_lag / linear[other].leg_lag,
        "linear_ideal": 1.0 - linear[one].ideal / linear[other].ideal,
    }


_COLUMNS = ("rig", "leg_lag", "linear_leg_lag", "ideal", "linear_ideal")


def _lines(values: dict[str, JsonValue], names: tuple[str, ...]) -> tuple[str, ...]:
    def row(head: str, key: str, style: str) -> str:
        found = values[key]
        cells = found if isinstance(found, dict) else {}
        shown = (f"{cells[c]:{style}}" if c in cells else f"{'':>15}" for c in _COLUMNS)
        return f"  {head:<22}" + "".join(shown)

    top = f"  {'energy integral [J s]':<22}" + "".join(f"{c:>15}" for c in _COLUMNS)
    return (
        top,
        *(row(name, name, "15.2f") for name in names),
        row("joints locked", "locked", "15.2f"),
        "",
        row("energy under pped by", "less_than_pped", "15.1%"),
        row("pped under high by", "pped_less_than_high", "15.1%"),
    )
