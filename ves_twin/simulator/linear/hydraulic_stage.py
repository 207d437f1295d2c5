"""hydraulic_stage: valve, oil and rod of one leg under load, linear and continuous."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.plant.hydraulics import Hydraulics, fill_chambers
from ves_twin.plant.physics import chambers
from ves_twin.plant.plant import Plant

if TYPE_CHECKING:
    from control import StateSpace

LENGTH, SPEED, ACCELERATION = 0, 1, 2
"""Outputs of the stage."""

LEG = 0
"""Whose valve and oil; legs differ only where a plant says so."""


def load_per_leg(plant: Plant) -> float:
    """Mass that one leg feels when the platform heaves at home [kg].

    A heave speed w turns all six legs at u w, u the cosine between leg and vertical, so that
    platform, arm and rods of mass M are 6 m with m = M / (6 u^2).
    """
    table = plant.actual
    mass = (
        table.number("platform.mass")
        + float(np.sum(table.array("arm.mass")))
        + 6.0 * table.number("leg.rod_mass")
    )
    return mass / float(np.sum(heave_cosines(plant) ** 2))


def heave_cosines(plant: Plant) -> FloatArray:
    """Cosines between the legs and the vertical at home (6,)."""
    return np.asarray(plant.geometry.jacobian(np.zeros(6))[:, 2])


def hydraulic_stage(plant: Plant, load: float) -> StateSpace:
    """From the held amplifier output, -1 to 1, to rod length, speed and acceleration.

    The spool lags, x' = (c - x) / lag. In the linear form it moves an oil column,
    z' = v0 x, and m q'' = k (z - q) - d q'. In the pressure form the chambers of a leg in mid
    stroke take its place, linear about the null and with the mean flow of both directions:
    m q'' = A1 p1 - A2 p2 - b q'.

    Args:
        plant: numbers, and the form of the hydraulics.
        load: mass that the leg moves [kg].

    Returns:
        A continuous system with one input and outputs LENGTH [m], SPEED, ACCELERATION.

    Source: thesis fig. 5-4 (servo actuator as an integrator); the oil is invented.
    """
    from control import StateSpace  # slow to import

    build = _oil_column if plant.hydraulics is Hydraulics.LINEAR else _chambers
    a, b = build(plant, load)
    c = np.zeros((3, len(a)))
    c[LENGTH, -2] = c[SPEED, -1] = 1.0
    c[ACCELERATION] = a[-1]
    return StateSpace(a, b[:, None], c, np.zeros((3, 1)))


def _oil_column(plant: Plant, load: float) -> tuple[FloatArray, FloatArray]:
    """States: spool, column, length, speed."""
    table = plant.actual
    array = table.array
    stiffness, damping = (array(f"hydraulics.oil_{n}")[LEG] for n in ("stiffness", "damping"))
    a, b = np.zeros((4, 4)), np.zeros(4)
    _lag(a, b, array("hydraulics.valve_lag")[LEG])
    gain = array("hydraulics.valve_gain")[LEG]
    a[1, 0] = gain * table.number("hydraulics.full_speed")
    a[2, 3] = 1.0
    a[3, 1:] = np.array([stiffness, -stiffness, -damping]) / load
    return a, b


def _chambers(plant: Plant, load: float) -> tuple[FloatArray, FloatArray]:
    """States: spool, pressures of piston and annulus, length, speed."""
    table = plant.actual
    array = table.array
    block = np.zeros(1, chambers.PARAMETERS)
    fill_chambers(block[0], table)
    p = block[0]
    area = np.array(p["area"])
    volume = p["dead_volume"][LEG] + area * p["half_stroke"]
    leak, null = p["leakage"][LEG], p["conductance"]
    speed = array("hydraulics.valve_gain")[LEG] * table.number("hydraulics.full_speed")
    flow = speed * area * [1.0, -1.0]
    pressures = np.array([[-null[0] - leak, leak], [leak, -null[1] - leak]])
    a, b = np.zeros((5, 5)), np.zeros(5)
    _lag(a, b, array("hydraulics.valve_lag")[LEG])
    per_volume = p["bulk_modulus"][LEG] / volume
    a[1:3, 0] = per_volume * flow
    a[1:3, 1:3] = per_volume[:, None] * pressures
    a[1:3, 4] = per_volume * area * [-1.0, 1.0]
    a[3, 4] = 1.0
    a[4, 1:3] = area * [1.0, -1.0] / load
    a[4, 4] = -p["viscous"][LEG] / load
    return a, b


def _lag(a: FloatArray, b: FloatArray, lag: float) -> None:
    a[0, 0], b[0] = -1.0 / lag, 1.0 / lag
