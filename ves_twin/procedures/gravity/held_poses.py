"""HeldPosesProcedure: what the experiments on held poses share: rig, poses, times, readings."""

from __future__ import annotations

from abc import ABC
from typing import Annotated

import numpy as np
from pydantic import Field

from ves_twin.core.types import FloatArray
from ves_twin.mechanics.gravity.observations import Observations
from ves_twin.plant.known_weight import hang_weight
from ves_twin.plant.plant import Plant
from ves_twin.procedures.gravity.rig_poses import RigPoses
from ves_twin.procedures.procedure import Procedure, Progress, RunContext
from ves_twin.scenario.fields import PerSecond, Seconds
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.static_poses import HoldTimes, hold_poses


class HeldPosesProcedure(Procedure, ABC):
    """An experiment that holds the rig at poses and reads the force sensor there.

    `spacing` is the time from one pose to the next: the way is not simulated, while the sensor's
    drift and slow noise go on.
    """

    belief: str = "ves2"
    poses: RigPoses = RigPoses()
    settle: Annotated[Seconds, Field(gt=0, le=100)] = 0.3
    average: Annotated[Seconds, Field(gt=0, le=100)] = 0.7
    spacing: Annotated[Seconds, Field(gt=0, le=1e4)] = 60.0
    legs_gain: Annotated[PerSecond, Field(gt=0)] = 12.6
    noise: bool = True
    seed: Annotated[int, Field(ge=0, lt=2**63)] = 0

    def world(self, conduct: RunContext) -> tuple[Plant, int]:
        """Plant and seed that count."""
        seed = self.seed if conduct.seed is None else conduct.seed
        return conduct.plant or Plant.load(self.plant), seed

    @property
    def scenario(self) -> Scenario:
        """Position control as in any run; pose and arm come from the list."""
        return Scenario.model_validate(
            {
                "name": self.name,
                "question": self.question,
                "plant": self.plant,
                "belief": self.belief,
                "run": {"duration": 1.0, "noise": self.noise},
                "platform": {"mode": "position"},
                "legs": {"gain": self.legs_gain},
            }
        )

    def read(
        self,
        plant: Plant,
        poses: FloatArray,
        q: FloatArray,
        seed: int,
        progress: Progress,
        weight: float = 0.0,
        first: int = 0,
    ) -> Observations:
        """Hold the poses (n, 6), (n, 3) and read them, with a known weight [kg] on the forearm."""
        world = hang_weight(plant, weight) if weight > 0.0 else plant
        times = HoldTimes(self.settle, self.average, self.spacing)
        held = hold_poses(
            self.scenario,
            world,
            poses,
            q,
            times,
            seed,
            first,
            lambda share: progress(share, "poses"),
        )
        tips = np.array([plant.arm.tip(angles) for angles in held.q])
        load = np.full(len(q), weight)
        return Observations(held.q, held.pose[:, 3:], held.signal, load, tips)
