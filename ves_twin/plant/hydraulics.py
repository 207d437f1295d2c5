"""Hydraulics: which form of the hydraulics a plant has, and the numbers of the pressure form.

Its codes are part of the compiled loop and enter the hash of `ves_twin.core.compiled`.
"""

from __future__ import annotations

from enum import StrEnum

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.plant.parameters import ParameterTable

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


_IDLE = {
    Hydraulics.LINEAR: (
        *("chamber.", "hydraulics.rated_pressure"),
        *("supply.droop", "supply.flow_limit", "supply.compliance"),
    ),
    Hydraulics.PRESSURE: ("hydraulics.oil_stiffness", "hydraulics.oil_damping"),
}
"""Beginnings of the parameters that a form does not know."""


def refuse_idle(form: Hydraulics, table: ParameterTable, nominal: ParameterTable) -> None:
    """Refuse changed parameters that would act on nothing.

    Oil stiffness and damping belong to the linear form, chambers and the manifold to the pressure
    form; flow limit and accumulator act only on a manifold with droop.

    Args:
        form: hydraulics of the plant.
        table: numbers of the plant.
        nominal: numbers of the shipped plant of this form.

    Raises:
        InvalidInputError: names the first such parameter and what would make it act.
    """
    other = Hydraulics.PRESSURE if form is Hydraulics.LINEAR else Hydraulics.LINEAR
    for name, (here, there) in table.differences(nominal).items():
        kept = f"{there.tolist()}, or a plant on which it acts: "
        if name.startswith(_IDLE[form]):
            raise InvalidInputError(name, here.tolist(), f'{kept}hydraulic_model = "{other}"')
        if name in {"supply.flow_limit", "supply.compliance"} and not table.number("supply.droop"):
            raise InvalidInputError(name, here.tolist(), f"{kept}supply.droop above 0")


def fill_chambers(p: np.void, table: ParameterTable) -> None:
    """Write the pressure form's PARAMETERS from a table.

    The valve ports are matched to the areas (K_B = K_A / R, R = A1 / A2), so that pressures do not
    jump at reversal. K_A is set so that the mean of extending and retracting at full opening,
    which differ by sqrt(R), is `hydraulics.full_speed` at `hydraulics.rated_pressure`: a plant of
    another supply has the same valve.

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
    ratio, rated = piston / annulus, number("hydraulics.rated_pressure")
    roots = np.sqrt(rated * ratio / (1.0 + ratio)), np.sqrt(rated / (1.0 + ratio))
    gain = number("hydraulics.full_speed") * piston / (0.5 * sum(roots))
    conductance = number("chamber.conductance")
    p["area"] = piston, annulus
    p["dead_volume"] = table.array("chamber.dead_volume")
    p["half_stroke"] = number("leg.stroke") / 2.0
    p["bulk_modulus"] = table.array("chamber.bulk_modulus")
    p["rated"] = rated
    p["flow_gain"] = gain, gain / ratio
    p["crossover"] = number("chamber.crossover")
    p["leakage"] = table.array("chamber.leakage")
    p["conductance"] = conductance, conductance / ratio
    p["null"] = rated / (1.0 + ratio), rated * ratio / (1.0 + ratio)
    p["viscous"] = table.array("chamber.viscous")


def resting_supply(supply: np.void, p: np.void) -> float:
    """Manifold pressure [Pa] under the null flow of six unloaded legs, P0 / (1 + 6 R cv / (1 + r)).

    Args:
        supply: one record of `supply.PARAMETERS`; R is its droop.
        p: one record of `chambers.PARAMETERS`; cv is its conductance on the piston side, r the
            ratio of the areas.
    """
    piston, annulus = p["area"]
    flow = p["conductance"][0] / (1.0 + piston / annulus)
    return float(supply["pressure"] / (1.0 + 6.0 * supply["droop"] * flow))


def loaded_pressures(p: np.void, force: FloatArray, supply: float | None = None) -> FloatArray:
    """Chamber pressures (6, 2) [Pa] that carry forces, shared evenly about the null.

    Args:
        p: one record of `chambers.PARAMETERS`.
        force: rod forces (6,) [N].
        supply: manifold pressure [Pa]; the rated one if not given.
    """
    piston, annulus = p["area"]
    low, high = p["null"] if supply is None else p["null"] * (supply / p["rated"])
    return np.column_stack([low + force / (2.0 * piston), high - force / (2.0 * annulus)])


def chamber_stiffness(p: np.void, travel: FloatArray) -> FloatArray:
    """Stiffness of the trapped oil k = beta (A1^2 / V1 + A2^2 / V2) [N/m] at rod travels [m]."""
    piston, annulus = p["area"]
    v1 = p["dead_volume"] + piston * (p["half_stroke"] + travel)
    v2 = p["dead_volume"] + annulus * (p["half_stroke"] - travel)
    return np.asarray(p["bulk_modulus"] * (piston**2 / v1 + annulus**2 / v2))
