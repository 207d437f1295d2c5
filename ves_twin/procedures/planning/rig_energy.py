"""RigOptions: a run of the rig that emulates a base, and the strain energy in it over time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from ves_twin.core.types import FloatArray
from ves_twin.mechanics.emulated import EmulatedSystem
from ves_twin.mechanics.planning.flexible_base import strain_energy
from ves_twin.plant.plant import Plant
from ves_twin.scenario.fields import ZERO_POSE, Hertz, Part, PerSecond
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.outcome import Outcome
from ves_twin.simulator.recorder import IDEAL, LEG_LAG
from ves_twin.simulator.simulate import simulate


@dataclass(frozen=True)
class RigEnergy:
    """Energy sum 1/2 k_ij Y_i Y_j of one run, a row each admittance cycle.

    Attributes:
        outcome: how the run ended.
        time: [s] (k,).
        energy: of the platform's true pose [J] (k,).
        ideal: of the same arm and servo in zero gravity [J] (k,).
        leg_lag: of the same with a platform that follows through the legs' lag alone [J] (k,).
        joint_peak: largest excursion of each joint from its command [rad] (3,).
    """

    outcome: Outcome
    time: FloatArray
    energy: FloatArray
    ideal: FloatArray
    leg_lag: FloatArray
    joint_peak: FloatArray

    @property
    def peak(self) -> float:
        """Largest energy of the true pose [J]."""
        return float(np.max(self.energy))

    def integrals(self) -> tuple[float, float, float]:
        """Integrals over the run of rig, leg-lag and ideal energy, by trapezoids [J s]."""
        rig, lag, ideal = (
            float(np.trapezoid(values, self.time))
            for values in (self.energy, self.leg_lag, self.ideal)
        )
        return rig, lag, ideal


class RigOptions(Part):
    """How the rig is run: clock, legs, what the computers believe, gravity from which file.

    Source: a coupled beam runs at 75 Hz (Appendix E), legs of about 2 Hz (5.2).
    """

    belief: str = "ves2"
    rate: Hertz = 75.0
    legs_gain: Annotated[PerSecond, Field(gt=0)] = 12.6
    gravity_file: str | None = None
    gravity_age: Annotated[int, Field(ge=0, le=50)] = 1
    noise: bool = True
    seed: Annotated[int, Field(ge=0, lt=2**63)] = 0

    def run(
        self,
        plant: Plant,
        seed: int | None,
        emulated: str,
        duration: float,
        arm: dict[str, Any],
        start: tuple[float, ...] = ZERO_POSE,
        compensated: bool = True,
        parameters: dict[str, Any] | None = None,
    ) -> RigEnergy:
        """Emulate a base under an arm, with the Model Method or without compensation.

        Args:
            plant: the world.
            seed: of the noise; None: the options' own.
            emulated: name of the base.
            duration: length of the run [s].
            arm: table `arm` of a scenario.
            start: pose of the base at release [m, rad].
            compensated: False: only the weight of the first moment is tared.
            parameters: changes of the plant.

        Raises:
            VesTwinError: a scenario that cannot be built.
        """
        gravity: dict[str, Any] = {"age": self.gravity_age}
        if compensated:
            gravity |= {"method": "model", "file": self.gravity_file}
        content = {
            "name": "energy",
            "question": "How much energy does the arm leave in the base?",
            "plant": plant.name,
            "belief": self.belief,
            "parameters": parameters or {},
            "run": {"duration": duration, "noise": self.noise, "seed": self.seed},
            "platform": {
                "mode": "micro_gravity",
                "rate": self.rate,
                "emulated": emulated,
                "start": start,
            },
            "gravity": gravity,
            "legs": {"gain": self.legs_gain},
            "arm": arm,
        }
        run = simulate(Scenario.model_validate(content), plant, seed)
        base = EmulatedSystem.load(emulated)
        rig, ideal, lag = (
            strain_energy(base, run[name]) for name in ("truth.pose", IDEAL, LEG_LAG)
        )
        peak = np.max(np.abs(run["truth.arm_q"] - run["arm.command"]), axis=0)
        return RigEnergy(Outcome(run.info.outcome), run.time, rig, ideal, lag, peak)
