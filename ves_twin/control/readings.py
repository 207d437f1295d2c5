"""Readings: what a controller may look at; live, read-only views of the measured signals."""

from __future__ import annotations

from dataclasses import dataclass

from ves_twin.core.types import FloatArray


@dataclass(frozen=True)
class Readings:
    """Measurements at the clock interrupt.

    Attributes:
        leg_length: measured leg lengths [m] (6,).
        wrench_in_sensor: wrench of the payload on the platform, sensor axes [N, N m] (6,).
        gravity_in_sensor: gravity wrench from shared memory, sensor axes [N, N m] (6,).
        arm_q: measured joint angles [rad] (3,).
        platform_command: pose commanded in the cycle before [m, rad] (6,).
        supply_pressure: manifold pressure [Pa] (1,).
    """

    leg_length: FloatArray
    wrench_in_sensor: FloatArray
    gravity_in_sensor: FloatArray
    arm_q: FloatArray
    platform_command: FloatArray
    supply_pressure: FloatArray
