"""LAW of the platform: what the compiled cycle runs of a platform controller."""

from __future__ import annotations

import numpy as np

from ves_twin.core.compiled import compiled
from ves_twin.core.types import Block, FloatArray
from ves_twin.mechanics.kinematics.rotations import matrix_from_angles
from ves_twin.mechanics.kinematics.wrenches import rotate_wrench, sensor_to_top

KNOWN, EMULATES = 0, 1
"""Kinds: a pose that no reading changes, asked of the controller ahead; the emulated base."""

LAW = np.dtype(
    [
        ("kind", np.int64),
        ("phi", np.float64, (12, 12)),
        ("gamma", np.float64, (12, 6)),
        ("position", np.float64, 3),
        ("home", np.float64, 6),
        ("share", np.float64),
        ("state", np.float64, 12),
    ]
)
"""kind; transition and input matrix of a cycle; origin of the sensor in the top frame [m]; pose at
which the base is at zero [m, rad]; share of the gravity estimate that is taken off; position and
velocity of the base."""


KNOWN_LAW: Block = np.zeros(1, LAW)
"""Of a controller whose pose depends on time alone."""


@compiled
def emulate(
    block: Block, reading: FloatArray, gravity: FloatArray, state: FloatArray
) -> FloatArray:
    """The emulated base one cycle on: its state (12,) is written, its pose (6,) comes back.

    Args:
        block: LAW (1,), stays as it is.
        reading: wrench in sensor axes [N, N m] (6,).
        gravity: estimate of its gravity part [N, N m] (6,).
        state: position and velocity at the next cycle (12,).
    """
    law = block[0]
    wrench = sensor_to_top(reading - law.share * gravity, law.position)
    wrench = rotate_wrench(matrix_from_angles(law.home[3:] + law.state[3:6]), wrench)
    state[:] = 0.0
    for i in range(12):
        for j in range(12):
            state[i] += law.phi[i, j] * law.state[j]
        for j in range(6):
            state[i] += law.gamma[i, j] * wrench[j]
    pose: FloatArray = law.home + state[:6]
    return pose
