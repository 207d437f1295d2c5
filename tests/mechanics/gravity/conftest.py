"""A payload on a sensor, and readings of it at poses, without a rig."""

from dataclasses import dataclass

import numpy as np
import pytest

from ves_twin.core.types import FloatArray
from ves_twin.mechanics.gravity.gravity_model import GravityModel
from ves_twin.mechanics.gravity.observations import Observations
from ves_twin.plant.plant import Plant

TILT = np.radians(10.0)


@dataclass(frozen=True)
class Bench:
    """The PUMA of the thesis on a sensor whose gain is off by a known or drawn amount."""

    model: GravityModel
    position: FloatArray
    full_scale: FloatArray
    noise: FloatArray
    offset: FloatArray

    @property
    def truth(self) -> FloatArray:
        return np.append(self.model.total_mass, self.model.moments)

    def poses(self, rng: np.random.Generator, count: int) -> tuple[FloatArray, FloatArray]:
        q = rng.uniform([-2.8, -0.7, -2.5], [2.8, 3.8, 2.5], (count, 3))
        return q, rng.uniform(-TILT, TILT, (count, 3))

    def readings(
        self, rng, q, angles, gain_sd=0.005, noise=1.0, weight=0.0, believed=None
    ) -> Observations:
        """Signals of the true angles; `believed` is what the identification is told instead."""
        n = len(q)
        load = np.where(np.arange(n) % 2 == 1, weight, 0.0)
        tips = self.model.basis.chain.frames(q)[:, -1, :3, 3]
        seen = Observations(q, angles, np.zeros((n, 6)), load, tips)
        regressor, known = seen.regressor(self.model.basis, self.position, self.model.gravity)
        share = gain_sd * rng.normal(size=(6, 6))
        gain = np.eye(6) + share * np.outer(self.full_scale, 1.0 / self.full_scale)
        wrench = regressor @ self.truth + known
        signal = wrench @ gain.T + self.offset + noise * self.noise * rng.normal(size=(n, 6))
        return Observations(q, angles if believed is None else believed, signal, load, tips)


@pytest.fixture(scope="session")
def bench() -> Bench:
    plant = Plant.load("ves2")
    array = plant.parameters.array
    # a hold averages the white noise; the slow one stays
    return Bench(
        plant.gravity_model,
        array("sensor.position"),
        array("sensor.range"),
        array("sensor.wander"),
        array("sensor.offset"),
    )
