"""puma_chain: the PUMA 560 of a plant as a serial chain, with split or with printed inertias."""

from __future__ import annotations

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.mechanics.planning.chain import SerialChain
from ves_twin.plant.plant import Plant

PRINTED_INERTIA = np.array(
    [[6.686, 6.465, 1.815], [0.615, 0.615, 0.081], [0.130, 0.524, 5.249], [0.015, 0.574, 1.424]]
)
"""Rotors inside zz of links 2 and 3, which no rigid body can have. Source: thesis B.2, E-28."""


def puma_chain(plant: Plant, printed: bool = False) -> SerialChain:
    """The arm of a plant in the platform top frame t, as described: who plans knows no effects.

    Args:
        plant: whose arm it is.
        printed: with the inertias of thesis B.2 and no rotors apart, as Appendix G has it.

    Source: thesis B.1, B.2, errata E-28, E-36.
    """
    array = plant.parameters.array
    inertia = PRINTED_INERTIA if printed else array("arm.inertia")
    return SerialChain.of(
        plant.arm.chain,
        array("arm.mass"),
        array("arm.com"),
        _diagonals(inertia),
        np.zeros(3) if printed else array("arm.armature"),
    )


def _diagonals(rows: FloatArray) -> FloatArray:
    return np.asarray(rows[:, :, None] * np.eye(3))
