"""declared_noise: the noise that the plant's own numbers declare, for every column compared."""

from __future__ import annotations

import numpy as np
from scipy.signal import butter, lfilter

from ves_twin.core.signals import SIGNALS
from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.record.residuals.noise import Noise, NoiseSource
from ves_twin.machines.ves2.forward import noise_of
from ves_twin.mechanics.kinematics.stewart import pose_jacobian
from ves_twin.plant.plant import Plant
from ves_twin.scenario.schema import Scenario

ZEROING = 1.5
"""What zeroing leaves, in sd of the sensor's slow part: that of the zero and that of the run."""

LAGS = 8


def declared_noise(plant: Plant, scenario: Scenario, period: float) -> dict[str, Noise]:
    """Noise of each column by name.

    The sensor's noise is white before its low-pass, so its colour on the rows is that of the
    filter; the valve command carries that of the transducers through the leg gain, the pose from
    lengths through the inverse kinematics at home.

    Args:
        plant: its numbers.
        scenario: gives the leg gain.
        period: of the rows [s].
    """
    sds = noise_of(plant)
    length = sds["leg.length"]
    sds["valve.command"] = (
        length * scenario.legs.gain / plant.parameters.number("hydraulics.full_speed")
    )
    g = plant.geometry
    to_pose = np.linalg.inv(pose_jacobian(np.zeros(6), g.base, g.top, g.home))
    sds["platform.pose"] = np.sqrt(to_pose**2 @ length**2)
    wander, time = (
        plant.parameters.array("sensor.wander"),
        plant.parameters.number("sensor.wander_time"),
    )
    colour = _filter_colour(plant, period)
    found = {}
    for name, values in sds.items():
        for i, column in enumerate(SIGNALS[name].columns):
            slow = float(wander[i]) if name == "sensor.wrench" else 0.0
            tint = colour if name == "sensor.wrench" else ()
            sd = float(values[i])
            found[column] = Noise(sd, tint, slow, time, ZEROING * slow, NoiseSource.DECLARED)
    return found


def _filter_colour(plant: Plant, period: float) -> tuple[float, ...]:
    """Autocorrelation on the rows of white noise behind the sensor's low-pass (2nd order)."""
    tick, corner = (plant.parameters.number(n) for n in ("clock.tick", "sensor.corner"))
    numerator, denominator = butter(2, corner, fs=1.0 / tick)
    impulse: FloatArray = lfilter(numerator, denominator, np.eye(1, int(0.5 / tick))[0])
    step = max(1, round(period / tick))
    power = impulse @ impulse
    lags = range(step, min(LAGS * step, len(impulse) // 2) + 1, step)
    return tuple(float(impulse[:-lag] @ impulse[lag:] / power) for lag in lags)
