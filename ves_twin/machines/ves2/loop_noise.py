"""with_loop_noise: declared noise, and what the loops make of it on a rig that stands.

Noise of the transducers moves the legs, which shakes the payload: at the sensor that is as large as
the sensor's own noise on some axes. No closed form gives it, so the plant stands for a while.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ves_twin.core.signals import SIGNALS
from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.record.residuals.noise import Noise
from ves_twin.diagnosis.record.residuals.spectrum import HANN, Power, score
from ves_twin.plant.plant import Plant
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.simulate import simulate

SECONDS = 20.0
BANDS = 12
"""Equal bands up to Nyquist: of 66 bins each in 20 s at 79 Hz, which tells a factor to 15 %."""

CLEAR = 3.5
"""Score from which a band counts as louder than declared."""

SEED = 1_000_003
"""Of the standing rig: not one that recordings have, so that their noise is another."""


def with_loop_noise(
    declared: dict[str, Noise], plant: Plant, scenario: Scenario, period: float
) -> dict[str, Noise]:
    """Noise of each column of a rig that stands, at least what is declared.

    Args:
        declared: noise of each column without the loops.
        plant: that stands.
        scenario: a position run that gives rates, gains and start.
        period: of the rows that the noise is for [s].
    """
    run = scenario.run.model_copy(update={"duration": SECONDS, "noise": True, "log": "leg"})
    arm = scenario.arm.model_copy(update={"moves": ()})
    stands = simulate(scenario.model_copy(update={"run": run, "arm": arm}), plant, SEED)
    when = np.arange(int(stands.time[-1] / period)) * period
    rows = np.minimum(np.searchsorted(stands.time, when), len(stands) - 1)
    found = dict(declared)
    for name in {n for n in SIGNALS if SIGNALS[n].columns[0] in declared}:
        for i, column in enumerate(SIGNALS[name].columns):
            found[column] = _louder(declared[column], stands[name][rows, i], period)
    return found


def _louder(noise: Noise, rows: FloatArray, period: float) -> Noise:
    power = Power(rows - rows.mean(), noise, period)
    ratio = power.found / power.expected
    band = np.minimum((power.frequency * 2.0 * period * BANDS).astype(np.int64), BANDS - 1)
    factors = []
    for k in range(BANDS):
        values = ratio[band == k]
        mean = float(np.mean(values))
        clear = score(mean, 2.0 * HANN * len(values)) > CLEAR
        factors.append(mean if clear else 1.0)
    if max(factors) == 1.0:
        return noise
    grid = np.asarray((np.arange(40 * BANDS) + 0.5) / (80 * BANDS * period), np.float64)
    flat = replace(noise, slow=0.0)
    before = flat.spectrum(grid, period).reshape(BANDS, -1)
    gain = np.mean(before * np.array(factors)[:, None]) / np.mean(before)
    return replace(noise, sd=noise.sd * float(np.sqrt(gain)), louder=tuple(factors))
