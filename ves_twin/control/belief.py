"""Belief: what the controllers take the rig to be; it may be wrong, the plant never sees it."""

from __future__ import annotations

from dataclasses import dataclass

from ves_twin.core.read_only import ReadOnly
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.gravity.gravity_model import GravityModel
from ves_twin.mechanics.kinematics.puma560 import Puma560
from ves_twin.mechanics.kinematics.stewart import StewartGeometry


@dataclass(frozen=True)
class Belief(ReadOnly):
    """Frozen numbers that controllers work with.

    Attributes:
        geometry: joint positions of the platform.
        arm: kinematics of the arm.
        sensor_position: origin of the sensor frame s in the top frame t [m] (3,).
        leg_travel: travel from home that commands may use, stroke less margin [m].
        full_speed: rod speed at full valve opening [m/s].
        gravity: M_total and P of the payload.
    """

    geometry: StewartGeometry
    arm: Puma560
    sensor_position: FloatArray
    leg_travel: float
    full_speed: float
    gravity: GravityModel
