"""Hydraulics: which form of the hydraulics a plant has, and the numbers of the pressure form.

Its codes are part of the compiled loop and enter the hash of `ves_twin.compiled`.
"""

from __future__ import annotations

from enum import StrEnum

import numpy as np

from ves_twin.errors import InvalidInputError
from ves_twin.plant.parameters import ParameterTable
from ves_twin.types import FloatArray

LINEAR_FORM, PRESSURE_FORM = 0, 1
"""Codes of the compiled loop."""


class Hydraulics(StrEnum):
    """How the cylinders are modelled.

    `linear`: an oil column that the valve moves (the small-signal limit). `pressure`: servovalve
    orifices, two chamber pressures with bulk modulus and leakage.
    """

    LINEAR = "linear"
    PRESSURE = "pressure"

    @property
    def code(self) -> int:
        """Number of the form in the compiled loop."""
        return PRESSURE_FORM if self is Hydraulics.PRESSURE else LINEAR_FORM


def fill_chambers(p: np.void, table: ParameterTable) -> None:
    """Write the pressure form's PARAMETERS from a table.

    The valve ports are matched to the areas (K_B = K_A / R, R = A1 / A2), so that pressures do not
    jump at reversal. K_A is set so that the mean of extending and retracting at full opening,
    which differ by sqrt(R), is `hydraulics.full_speed` at the nominal supply.

    Args:
        p: one record of `chambers.PARAMETERS`.
        table: numbers of the plant.

    Raises:
        InvalidInputError: a rod as thick as the bore.
    """
    number = table.number
    piston = np.pi / 4.0 * number("chamber.bore") ** 2
    annulus = piston - np.pi * number("leg.rod_radius") ** 2
    if not 0.0 < annulus < piston:
        raise InvalidInputError(
            "chamber.bore", number("chamber.bore"), "a bore wider than the rod (leg.rod_radius)"
        )
    ratio, supply = piston / annulus, number("supply.pressure")
    roots = np.sqrt(supply * ratio / (1.0 + ratio)), np.sqrt(supply / (1.0 + ratio))
    gain = number("hydraulics.full_speed") * piston / (0.5 * sum(roots))
    conductance = number("chamber.conductance")
    p["area"] = piston, annulus
    p["dead_volume"] = number("chamber.dead_volume")
    p["half_stroke"] = number("leg.stroke") / 2.0
    p["bulk_modulus"] = number("chamber.bulk_modulus")
    p["supply"] = supply
    p["flow_gain"] = gain, gain / ratio
    p["crossover"] = number("chamber.crossover")
    p["leakage"] = number("chamber.leakage")
    p["conductance"] = conductance, conductance / ratio
    p["null"] = supply / (1.0 + ratio), supply * ratio / (1.0 + ratio)
    p["viscous"] = number("chamber.viscous")


def loaded_pressures(p: np.void, force: FloatArray) -> FloatArray:
    """Chamber pressures (6, 2) [Pa] that carry forces (6,) [N], shared evenly about the null."""
    piston, annulus = p["area"]
    low, high = p["null"]
    return np.column_stack([low + force / (2.0 * piston), high - force / (2.0 * annulus)])


def chamber_stiffness(p: np.void, travel: FloatArray) -> FloatArray:
    """Stiffness of the trapped oil k = beta (A1^2 / V1 + A2^2 / V2) [N/m] at rod travels [m]."""
    piston, annulus = p["area"]
    v1 = p["dead_volume"] + piston * (p["half_stroke"] + travel)
    v2 = p["dead_volume"] + annulus * (p["half_stroke"] - travel)
    return np.asarray(p["bulk_modulus"] * (piston**2 / v1 + annulus**2 / v2))
