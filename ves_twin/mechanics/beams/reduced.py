"""consistent_mass: the mass that a bent tube shows at its free end, by its static shapes."""

from __future__ import annotations

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.mechanics.beams.section import Tube
from ves_twin.mechanics.beams.unit_loads import (
    section_compliance,
    stations,
    transport,
    unit_load_compliance,
)


def consistent_mass(points: FloatArray, tube: Tube) -> FloatArray:
    """Mass matrix at the tip for motions in which the tube bends as under a load on its tip.

    The static shape N(s) = C(s, tip) C(tip, tip)^-1 gives the motion of every section from the
    tip's, and M = int N' m N ds with m = blkdiag(rho A 1, rho (I (1 - e e') + J e e')). For a
    straight beam these are the 156/420, 22/420 and 4/420 of the cubic beam element, so the end
    mass is 0.371 of the beam's; the rule of the thesis (half the mass, and that times L^2) makes
    the end inertia 52 times too large.

    Args:
        points: corners of the centre line from the clamped root to the tip [m] (k, 3).
        tube: cross-section.

    Returns:
        M (6, 6), full, symmetric, positive definite [kg, kg m, kg m^2].

    Source: static condensation (Guyan 1965); thesis A.2 against it in errata E-13.
    """
    corners = np.asarray(points, float)
    tip = corners[-1]
    stiffness = np.linalg.inv(unit_load_compliance(corners, tube))
    density = tube.material.density
    mass = np.zeros((6, 6))
    for k in range(len(corners) - 1):
        for position, weight, axis in stations(corners[k : k + 2]):
            clamped = np.vstack([corners[: k + 1], position])
            shape = _compliance_at(clamped, tip, tube) @ stiffness
            along = np.outer(axis, axis)
            section = np.zeros((6, 6))
            section[:3, :3] = tube.mass_per_length * np.eye(3)
            section[3:, 3:] = density * tube.second_moment * (np.eye(3) + along)
            mass += weight * shape.T @ section @ shape
    return (mass + mass.T) / 2


def _compliance_at(points: FloatArray, tip: FloatArray, tube: Tube) -> FloatArray:
    """Displacement of the last of `points` per wrench on the tip further out (6, 6)."""
    here = points[-1]
    total = np.zeros((6, 6))
    for position, weight, axis in stations(points):
        total += (
            weight
            * transport(here - position).T
            @ section_compliance(axis, tube)
            @ transport(tip - position)
        )
    return total
