"""straight_compliance and bent_compliance: the closed forms of thesis Appendix A."""

from __future__ import annotations

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.beams.section import Tube, check_positive


def straight_compliance(length: float, tube: Tube, direction: FloatArray) -> FloatArray:
    """Compliance at the tip of a straight cantilever of any orientation.

    For a beam along +Z: Q11 = Q22 = L^3/3EI, Q33 = L/EA, Q44 = Q55 = L/EI, Q66 = L/GJ,
    Q15 = Q51 = L^2/2EI, Q24 = Q42 = -L^2/2EI; turned so that +Z becomes `direction`.

    Args:
        length: L [m].
        tube: cross-section.
        direction: from root to tip (3,), any length.

    Returns:
        Q (6, 6) of (displacement, rotation) per (force, moment) at the tip.

    Source: thesis A.2, errata E-14 (Q15, Q66), E-12 (signs of the horizontal beam).
    """
    check_positive("beam length", length)
    ei = tube.bending
    q = np.diag(
        [
            *[length**3 / (3 * ei)] * 2,
            length / tube.axial,
            *[length / ei] * 2,
            length / tube.torsion,
        ]
    )
    q[0, 4] = q[4, 0] = length**2 / (2 * ei)
    q[1, 3] = q[3, 1] = -(length**2) / (2 * ei)
    return turned(q, rotation_from_z(direction))


def bent_compliance(l1: float, l2: float, tube: Tube, printed: bool = False) -> FloatArray:
    """Compliance at the tip of a beam bent once: L1 from the root along -X, then L2 along +Z.

    Args:
        l1: length of the clamped part [m].
        l2: length of the part that carries the platform [m].
        tube: cross-section of both.
        printed: with the slip Q55 = L2/EI + L1/GJ of which the printed stiffness is the inverse;
            about Y the part L1 bends, so L1/EI is right.

    Returns:
        Q (6, 6) of (displacement, rotation) per (force, moment) at the tip.

    Source: thesis A.4, errata E-15, E-19.
    """
    check_positive("beam l1", l1)
    check_positive("beam l2", l2)
    ei, gj, ea = tube.bending, tube.torsion, tube.axial
    q = np.zeros((6, 6))
    q[0, 0] = l2**3 / (3 * ei) + l1 / ea + l2**2 * l1 / ei
    q[0, 2] = q[2, 0] = l2 * l1**2 / (2 * ei)
    q[0, 4] = q[4, 0] = l2**2 / (2 * ei) + l2 * l1 / ei
    q[1, 1] = (l1**3 + l2**3) / (3 * ei) + l2**2 * l1 / gj
    q[1, 3] = q[3, 1] = -(l2**2) / (2 * ei) - l1 * l2 / gj
    q[1, 5] = q[5, 1] = -(l1**2) / (2 * ei)
    q[2, 2] = l2 / ea + l1**3 / (3 * ei)
    q[2, 4] = q[4, 2] = l1**2 / (2 * ei)
    q[3, 3] = l2 / ei + l1 / gj
    q[4, 4] = l2 / ei + (l1 / gj if printed else l1 / ei)
    q[5, 5] = l2 / gj + l1 / ei
    return q


def rotation_from_z(direction: FloatArray) -> FloatArray:
    """A rotation (3, 3) whose third column is the unit vector of `direction`.

    Raises:
        InvalidInputError: a direction without length.
    """
    given = np.asarray(direction, float)
    size = np.linalg.norm(given)
    if given.shape != (3,) or not (np.isfinite(size) and size > 0):
        raise InvalidInputError("beam direction", direction, "3 finite numbers, not all zero")
    axis = given / size
    helper = np.eye(3)[int(np.argmin(np.abs(axis)))]
    first = np.cross(helper, axis)
    first /= np.linalg.norm(first)
    return np.column_stack([first, np.cross(axis, first), axis])


def turned(matrix: FloatArray, rotation: FloatArray) -> FloatArray:
    """A (6, 6) matrix of forces and moments in axes turned by a rotation (3, 3)."""
    both = np.zeros((6, 6))
    both[:3, :3] = both[3:, 3:] = rotation
    return both @ matrix @ both.T
