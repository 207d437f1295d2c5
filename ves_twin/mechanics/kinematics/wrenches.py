"""Wrenches: from the sensor's axes and origin to the platform's, and back."""

from __future__ import annotations

import numpy as np

from ves_twin.core.compiled import compiled
from ves_twin.core.types import FloatArray


@compiled
def sensor_to_top(wrench_in_sensor: FloatArray, position: FloatArray) -> FloatArray:
    """Wrench in frame s as a wrench in the top frame t, about its origin.

    s is t turned by 180 deg about x: F_t = (Fx, -Fy, -Fz), M_t = (Mx, -My, -Mz) + p x F_t.

    Args:
        wrench_in_sensor: force and moment in s [N, N m] (6,).
        position: origin of s in t [m] (3,).

    Returns:
        Force and moment in t [N, N m] (6,).

    Source: thesis eq. D.1 with the last sign corrected, errata E-32.
    """
    fx, fy, fz = wrench_in_sensor[0], -wrench_in_sensor[1], -wrench_in_sensor[2]
    x, y, z = position[0], position[1], position[2]
    result = np.empty(6)
    result[0], result[1], result[2] = fx, fy, fz
    result[3] = wrench_in_sensor[3] + y * fz - z * fy
    result[4] = -wrench_in_sensor[4] + z * fx - x * fz
    result[5] = -wrench_in_sensor[5] + x * fy - y * fx
    return result


@compiled
def top_to_sensor(wrench_in_top: FloatArray, position: FloatArray) -> FloatArray:
    """Wrench about the origin of t, in t, as a wrench in frame s; inverse of `sensor_to_top`."""
    fx, fy, fz = wrench_in_top[0], wrench_in_top[1], wrench_in_top[2]
    x, y, z = position[0], position[1], position[2]
    result = np.empty(6)
    result[0], result[1], result[2] = fx, -fy, -fz
    result[3] = wrench_in_top[3] - (y * fz - z * fy)
    result[4] = -(wrench_in_top[4] - (z * fx - x * fz))
    result[5] = -(wrench_in_top[5] - (x * fy - y * fx))
    return result


@compiled
def rotate_wrench(rotation: FloatArray, wrench: FloatArray) -> FloatArray:
    """Force and moment (6,) turned by a rotation (3, 3), about the same point."""
    result = np.empty(6)
    for i in range(3):
        result[i] = (
            rotation[i, 0] * wrench[0] + rotation[i, 1] * wrench[1] + rotation[i, 2] * wrench[2]
        )
        result[3 + i] = (
            rotation[i, 0] * wrench[3] + rotation[i, 1] * wrench[4] + rotation[i, 2] * wrench[5]
        )
    return result
