"""CalibratePoses: force sensor and payload identified from readings at many poses."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

import numpy as np
from pydantic import Field

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.gravity.calibration import GravityCalibration
from ves_twin.mechanics.gravity.identify import identify
from ves_twin.mechanics.gravity.interleaved_split import alternate
from ves_twin.mechanics.gravity.observations import Observations
from ves_twin.mechanics.gravity.poses import conditioning
from ves_twin.plant.plant import Plant
from ves_twin.procedures.gravity.gravity_report import Calibrated, result_of, write_report
from ves_twin.procedures.gravity.held_poses import HeldPosesProcedure
from ves_twin.procedures.procedure import Result, RunContext, part_of
from ves_twin.scenario.fields import named, si
from ves_twin.simulator.build import belief_of


class Pin(StrEnum):
    """What fixes the directions that poses under gravity alone cannot show."""

    GAIN_PRIOR = "gain_prior"
    WEIGHT = "weight"
    NONE = "none"


class CalibratePoses(HeldPosesProcedure):
    """Thesis 3.4.5, 3.4.6: hold the poses, alternate P and C, and fit all at once.

    `pin`: `gain_prior` takes the sensor's nominal gain as known to `gain_sd` of full scale;
    `weight` hangs a known weight on the forearm at every second pose; `none` leaves hidden what
    is hidden. The calibration file holds the fit of all at once.
    """

    passes: Annotated[int, Field(ge=1, le=50)] = 2
    pin: Annotated[Pin, named("pin", [p.value for p in Pin])] = Pin.GAIN_PRIOR
    gain_sd: Annotated[float, Field(gt=0, le=1)] = 0.005
    weight: Annotated[float, si("kg"), Field(gt=0, le=20)] = 5.0

    def carry_out(self, conduct: RunContext) -> Result:
        """Hold, fit, write `gravity.toml`, `report.md` and `residuals.png`.

        Raises:
            InvalidInputError: too few or degenerate poses (says what is hidden), saturated sensor.
            UnreachableError: a pose outside the workspace.
        """
        plant, seed = self.world(conduct)
        belief = belief_of(self.scenario)
        full_scale = plant.parameters.array("sensor.range")
        poses, q = self.poses.choose(belief, full_scale, seed)
        observations = self._observe(conduct, plant, poses, q, seed)
        basis, position = belief.gravity.basis, belief.sensor_position
        gravity = belief.gravity.gravity
        passes = alternate(observations, basis, position, gravity, self.passes + 1)
        prior = self.gain_sd if self.pin is Pin.GAIN_PRIOR else None
        found = identify(observations, basis, position, gravity, full_scale, prior)
        name, file = (
            f"{self.name}, seed {seed}, plant {plant.name}",
            conduct.folder / "gravity.toml",
        )
        GravityCalibration.of(found, plant.sensor_identity, name).save(file)
        result = Calibrated(
            passes=passes,
            found=found,
            pin=self.pin.value,
            truth=_truth(plant),
            conditioning=conditioning(belief.gravity, position, full_scale, q, poses[:, 3:]),
        )
        write_report(result, conduct.folder, self.question)
        return result_of(result)

    def _observe(
        self, conduct: RunContext, plant: Plant, poses: FloatArray, q: FloatArray, seed: int
    ) -> Observations:
        if self.pin is not Pin.WEIGHT:
            return self.read(plant, poses, q, seed, conduct.progress)
        if len(poses) < 2:
            raise InvalidInputError("poses.count", len(poses), "at least 2 for pin = 'weight'")
        bare = self.read(plant, poses[::2], q[::2], seed, part_of(conduct.progress, 0, 2))
        loaded = self.read(
            plant,
            poses[1::2],
            q[1::2],
            seed,
            part_of(conduct.progress, 1, 2),
            self.weight,
            len(bare),
        )
        return bare.joined(loaded)


def _truth(plant: Plant) -> FloatArray:
    model = plant.gravity_model
    return np.concatenate([[model.total_mass], model.moments])
