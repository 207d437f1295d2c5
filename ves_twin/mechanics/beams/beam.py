"""StraightBeam and BentBeam: mass, damping and stiffness of a beam that carries the platform."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.read_only import ReadOnly
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.beams.damping import modal_damping, product_root, square_root
from ves_twin.mechanics.beams.formulas import (
    bent_compliance,
    rotation_from_z,
    straight_compliance,
    turned,
)
from ves_twin.mechanics.beams.reduced import consistent_mass
from ves_twin.mechanics.beams.section import Tube, check_positive

DAMPING_RATIO = 0.05
"""Every beam of the thesis. Source: thesis A.2, A.4."""

TORSIONAL_INERTIA = 5.0
"""End inertia of a straight beam about its own axis [kg m^2], printed without a formula (E-10)."""

TORSIONAL_INERTIA_IN_DAMPING = 0.143
"""What the printed torsional damping of 2 N m s/rad was computed with [kg m^2] (E-11)."""


@dataclass(frozen=True)
class BeamMatrices(ReadOnly):
    """M Y'' + B Y' + K Y = W at the free end, Y = (X, Y, Z, phiX, phiY, phiZ).

    Attributes:
        mass: M (6, 6) [kg, kg m, kg m^2].
        damping: B (6, 6) [N s/m, N s, N m s].
        stiffness: K (6, 6) [N/m, N, N m].
    """

    mass: FloatArray
    damping: FloatArray
    stiffness: FloatArray


@dataclass(frozen=True)
class StraightBeam:
    """A straight cantilever.

    Attributes:
        length: L [m].
        tube: cross-section.
        direction: from root to platform (3,); (0, 0, 1) is the vertical beam of the thesis,
            (-1, 0, 0) the horizontal one (errata E-12).
    """

    length: float
    tube: Tube
    direction: tuple[float, float, float] = (0.0, 0.0, 1.0)

    def __post_init__(self) -> None:
        check_positive("beam length", self.length)
        rotation_from_z(np.array(self.direction))

    @property
    def points(self) -> FloatArray:
        """Root and tip [m] (2, 3); the platform is the origin."""
        axis = rotation_from_z(np.array(self.direction))[:, 2]
        return np.vstack([-self.length * axis, np.zeros(3)])

    def corrected(self, ratio: float = DAMPING_RATIO) -> BeamMatrices:
        """By the rule of A.2: half the mass at the end, that times L^2, torsion on its own axis."""
        compliance = straight_compliance(self.length, self.tube, np.array(self.direction))
        stiffness = _stiffness(compliance)
        mass = turned(self._end_mass(TORSIONAL_INERTIA), rotation_from_z(np.array(self.direction)))
        return _with_modal_damping(mass, stiffness, ratio)

    def reduced(self, ratio: float = DAMPING_RATIO) -> BeamMatrices:
        """The beam's own mass by its static shapes, full and symmetric."""
        compliance = straight_compliance(self.length, self.tube, np.array(self.direction))
        mass = consistent_mass(self.points, self.tube)
        return _with_modal_damping(mass, _stiffness(compliance), ratio)

    def thesis(self) -> BeamMatrices:
        """As printed in A.3, unrounded: M of the other orientation, diagonal damping.

        The damping is the diagonal of 2 zeta K^1/2 M^1/2 with a torsional inertia of 0.143 kg m^2.

        Raises:
            InvalidInputError: neither along Z nor along X; nothing else is printed.

        Source: thesis A.3, errata E-10, E-11.
        """
        rotation = rotation_from_z(np.array(self.direction))
        along = np.abs(rotation[:, 2])
        if not np.isclose(max(along[0], along[2]), 1.0):
            expected = "(0, 0, 1) or (-1, 0, 0); the thesis prints no other straight beam"
            raise InvalidInputError("beam direction in form 'thesis'", self.direction, expected)
        other = np.eye(3)[:, ::-1] if along[2] > along[0] else np.eye(3)
        upright = _stiffness(straight_compliance(self.length, self.tube, np.array([0, 0, 1.0])))
        damped = self._end_mass(TORSIONAL_INERTIA_IN_DAMPING)
        product = square_root(upright) @ square_root(damped)
        damping = turned(np.diag(2 * DAMPING_RATIO * np.diag(product)), rotation)
        mass = turned(self._end_mass(TORSIONAL_INERTIA), other)
        return BeamMatrices(mass, damping, turned(upright, rotation))

    def _end_mass(self, torsional: float) -> FloatArray:
        half = self.tube.mass_per_length * self.length / 2
        return np.diag([half, half, half, *[half * self.length**2] * 2, torsional])


@dataclass(frozen=True)
class BentBeam:
    """A cantilever bent once: from its root L1 along -X, then L2 along +Z to the platform.

    Attributes:
        l1: length of the clamped part [m].
        l2: length of the part that carries the platform [m].
        tube: cross-section.
    """

    l1: float
    l2: float
    tube: Tube

    def __post_init__(self) -> None:
        check_positive("beam l1", self.l1)
        check_positive("beam l2", self.l2)

    @property
    def points(self) -> FloatArray:
        """Root, corner and tip [m] (3, 3); the platform is the origin."""
        return np.array([[self.l1, 0.0, -self.l2], [0.0, 0.0, -self.l2], [0.0, 0.0, 0.0]])

    def corrected(self, ratio: float = DAMPING_RATIO) -> BeamMatrices:
        """By the formulas of A.4 with Q55 put right and the inertias on their axes."""
        stiffness = _stiffness(bent_compliance(self.l1, self.l2, self.tube))
        half, xx, yy, zz = self._end_inertia()
        return _with_modal_damping(np.diag([half, half, half, xx, yy, zz]), stiffness, ratio)

    def reduced(self, ratio: float = DAMPING_RATIO) -> BeamMatrices:
        """The beam's own mass by its static shapes, full and symmetric."""
        stiffness = _stiffness(bent_compliance(self.l1, self.l2, self.tube))
        return _with_modal_damping(consistent_mass(self.points, self.tube), stiffness, ratio)

    def thesis(self) -> BeamMatrices:
        """As printed in A.5, unrounded: K of the wrong Q55, yy and zz of M interchanged, B skew.

        B is 2 zeta times the matrix root of K M with the whole beam's mass in translation.

        Source: thesis A.5, errata E-15, E-17, E-18.
        """
        stiffness = _stiffness(bent_compliance(self.l1, self.l2, self.tube, printed=True))
        half, xx, yy, zz = self._end_inertia()
        whole = np.diag([2 * half, 2 * half, 2 * half, xx, zz, yy])
        damping = 2 * DAMPING_RATIO * product_root(whole, stiffness)
        return BeamMatrices(np.diag([half, half, half, xx, zz, yy]), damping, stiffness)

    def _end_inertia(self) -> tuple[float, float, float, float]:
        half = self.tube.mass_per_length * (self.l1 + self.l2) / 2
        return half, half * self.l2**2, half * (self.l1**2 + self.l2**2), half * self.l1**2


def _with_modal_damping(mass: FloatArray, stiffness: FloatArray, ratio: float) -> BeamMatrices:
    return BeamMatrices(mass, modal_damping(mass, stiffness, ratio), stiffness)


def _stiffness(compliance: FloatArray) -> FloatArray:
    inverse = np.linalg.inv(compliance)
    return np.asarray((inverse + inverse.T) / 2, dtype=np.float64)
