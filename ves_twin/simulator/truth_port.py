"""GravityTruth: the plant's own gravity wrench, for the test compensation alone."""

from __future__ import annotations

from typing import ClassVar

import mujoco
import numpy as np

from ves_twin.control.gravity_law import TRUTH_LAW
from ves_twin.core.compiled import compiled
from ves_twin.core.types import Block, FloatArray
from ves_twin.plant.layout import Layout


class GravityTruth:
    """Implements `ves_twin.control.gravity.TruthPort` on a live MjData.

    Attributes:
        arrays: what `gravity_wrench` takes, live.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, layout: Layout) -> None:
        self.arrays: tuple[FloatArray, FloatArray, FloatArray, FloatArray] = (
            model.opt.gravity * float(model.body_subtreemass[layout.sensor_body]),
            data.subtree_com[layout.sensor_body],
            data.site_xpos[layout.sensor_site],
            data.site_xmat[layout.sensor_site],
        )

    law: ClassVar[Block] = TRUTH_LAW
    """The compiled cycle reads `arrays` itself."""

    def gravity_in_sensor(self) -> FloatArray:
        """Weight of everything above the sensor and its moment, sensor axes [N, N m] (6,)."""
        return gravity_wrench(*self.arrays)


@compiled
def gravity_wrench(
    weight: FloatArray, com: FloatArray, origin: FloatArray, axes: FloatArray
) -> FloatArray:
    """Static wrench of a weight about a sensor's origin: F = R' m g, M = R' (r x m g).

    Args:
        weight: m g, inertial axes [N] (3,).
        com: centre of mass, inertial [m] (3,).
        origin: origin of the sensor, inertial [m] (3,).
        axes: rotation sensor to inertial, row-major (9,).

    Returns:
        Wrench in sensor axes [N, N m] (6,).

    Source: thesis eq. 3.7 (sum from link 0, errata E-9).
    """
    moment = np.cross(com - origin, weight)
    result = np.zeros(6)
    for i in range(3):
        for j in range(3):
            result[i] += axes[3 * j + i] * weight[j]
            result[3 + i] += axes[3 * j + i] * moment[j]
    return result
