"""sensor_run: the force sensor alone under a constant wrench, for hours."""

from __future__ import annotations

import numpy as np

from ves_twin.core.compiled import compiled
from ves_twin.core.types import Block, FloatArray, SingleArray
from ves_twin.plant.parameters import ParameterTable
from ves_twin.plant.physics import force_sensor
from ves_twin.plant.physics.force_sensor import sample_wrench, start_at, wander_on
from ves_twin.simulator.blocks import fill_sensor
from ves_twin.simulator.codes import SLOW

RATE = 100.0
"""Samples a second [Hz]: enough for the 20 Hz low-pass, a thirtieth of the rig's rate."""


def sensor_run(
    table: ParameterTable, wrench: FloatArray, seconds: int, drift: FloatArray, seed: int
) -> tuple[FloatArray, FloatArray]:
    """Readings of the sensor by the rig's own kernels.

    Args:
        table: numbers of the sensor.
        wrench: constant wrench in the sensor [N, N m] (6,).
        seconds: how long.
        drift: drift of each axis [N/s, N m/s] (6,).
        seed: of the noise.

    Returns:
        The reading at the end of each second, and the mean over it, both with their offset
        [N, N m] (seconds, 6).
    """
    parameters: Block = np.zeros(1, force_sensor.PARAMETERS)
    state: Block = np.zeros(1, force_sensor.STATE)
    fill_sensor(parameters[0], table, 1.0 / RATE)
    parameters["drift"] = drift
    rng = np.random.default_rng(seed)
    start_at(parameters[0], state[0], wrench, rng.standard_normal(6, dtype=np.float32))
    readings, means = np.empty((seconds, 6)), np.empty((seconds, 6))
    block = 600
    ticks = int(RATE)
    for first in range(0, seconds, block):
        count = min(block, seconds - first)
        white = rng.standard_normal((count * ticks, 6), dtype=np.float32)
        slow = rng.standard_normal((count * ticks // SLOW + 2, 6), dtype=np.float32)
        rows = slice(first, first + count)
        _run(parameters, state, wrench, first, ticks, white, slow, readings[rows], means[rows])
    return readings, means


@compiled
def _run(
    parameters: Block,
    state: Block,
    wrench: FloatArray,
    first: int,
    ticks: int,
    white: SingleArray,
    slow: SingleArray,
    readings: FloatArray,
    means: FloatArray,
) -> None:
    p, s = parameters[0], state[0]
    start = first * ticks
    total = np.zeros(6)
    for k in range(white.shape[0]):
        tick = start + k
        if tick % SLOW == 0:
            wander_on(p, s, slow[k // SLOW])
        sample_wrench(p, s, wrench, tick / ticks, white[k])
        for i in range(6):
            total[i] += s.reading[i]
        if (k + 1) % ticks == 0:
            row = (k + 1) // ticks - 1
            for i in range(6):
                readings[row, i] = s.reading[i]
                means[row, i] = total[i] / ticks
                total[i] = 0.0
