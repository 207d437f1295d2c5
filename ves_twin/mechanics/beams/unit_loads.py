"""unit_load_compliance: compliance of a bent tube by virtual work along its centre line."""

from __future__ import annotations

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.beams.section import Tube

NODES = 4
"""Gauss points a segment; the integrands are polynomials of degree 6 at most, so exact."""


def unit_load_compliance(points: FloatArray, tube: Tube) -> FloatArray:
    """Displacement of the free end per wrench on it, any polyline of tube clamped at its first end.

    A unit wrench on the tip gives at the point s of the centre line the internal wrench X(s), and
    virtual work adds what each piece gives way:

        C = int X(s)' F(s) X(s) ds,  X = [[1, 0], [(r_tip - r(s)) x, 1]],
        F = blkdiag(e e'/EA, e e'/GJ + (1 - e e')/EI),  e the axis of the tube.

    Args:
        points: corners of the centre line from the clamped root to the tip [m] (k, 3).
        tube: cross-section.

    Returns:
        C (6, 6) of (displacement, rotation) per (force, moment), axes of `points`, about the tip
        [m/N, rad/N, 1/N, rad/(N m)]. Shear does not give way, as in the thesis.

    Raises:
        InvalidInputError: fewer than two points, or a segment without length.

    Source: the method of thesis A.4 carried out by integration; errata E-15, E-19.
    """
    tip = np.asarray(points, float)[-1]
    total = np.zeros((6, 6))
    for position, weight, axis in stations(points):
        lever = transport(tip - position)
        total += weight * lever.T @ section_compliance(axis, tube) @ lever
    return total


def stations(points: FloatArray) -> list[tuple[FloatArray, float, FloatArray]]:
    """Gauss points of a polyline: position [m] (3,), weight [m], unit axis (3,), root to tip."""
    corners = np.asarray(points, float)
    if corners.ndim != 2 or corners.shape[0] < 2 or corners.shape[1] != 3:
        raise InvalidInputError("beam points", f"shape {corners.shape}", "two or more rows of 3")
    lengths = np.linalg.norm(np.diff(corners, axis=0), axis=1)
    if not (np.all(np.isfinite(corners)) and np.all(lengths > 0)):
        raise InvalidInputError("beam points", corners.tolist(), "finite, different neighbours")
    places, weights = np.polynomial.legendre.leggauss(NODES)
    found = []
    for start, end, length in zip(corners[:-1], corners[1:], lengths, strict=True):
        for u, w in zip((places + 1) / 2, weights / 2, strict=True):
            found.append((start + u * (end - start), float(w * length), (end - start) / length))
    return found


def section_compliance(axis: FloatArray, tube: Tube) -> FloatArray:
    """Strain and curvature per internal force and moment (6, 6) of a tube along a unit axis."""
    along = np.outer(axis, axis)
    compliance = np.zeros((6, 6))
    compliance[:3, :3] = along / tube.axial
    compliance[3:, 3:] = along / tube.torsion + (np.eye(3) - along) / tube.bending
    return compliance


def transport(arm: FloatArray) -> FloatArray:
    """Wrench at a point per wrench at point + arm (6, 6): the moment gains arm x force."""
    x, y, z = arm
    lever = np.eye(6)
    lever[3:, :3] = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]]
    return lever
