"""Tube: the round hollow cross-section of a beam and what it weighs and resists."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ves_twin.core.errors import InvalidInputError


def check_positive(what: str, value: float) -> None:
    """Raise InvalidInputError unless a number is finite and above zero."""
    if not (math.isfinite(value) and value > 0):
        raise InvalidInputError(what, value, "a finite number above zero")


@dataclass(frozen=True)
class Material:
    """An isotropic elastic material.

    Attributes:
        elasticity: Young's modulus E [Pa].
        rigidity: shear modulus G [Pa].
        density: rho [kg/m^3].
    """

    elasticity: float
    rigidity: float
    density: float

    def __post_init__(self) -> None:
        for name in ("elasticity", "rigidity", "density"):
            check_positive(f"material {name}", getattr(self, name))


ALUMINIUM = Material(elasticity=72e9, rigidity=27e9, density=2.8e3)
"""Aluminium of every beam of the thesis. Source: thesis A.2, A.4."""


@dataclass(frozen=True)
class Tube:
    """A round tube: I = pi/64 (Do^4 - Di^4), J = 2 I, A = pi/4 (Do^2 - Di^2), Di = Do - 2 t.

    Attributes:
        outer_diameter: Do [m].
        wall: thickness t [m]; half the diameter makes a solid bar.
        material: what it is made of.

    Source: thesis A.3.
    """

    outer_diameter: float
    wall: float
    material: Material = ALUMINIUM

    def __post_init__(self) -> None:
        check_positive("beam outer_diameter", self.outer_diameter)
        check_positive("beam wall", self.wall)
        if self.wall > self.outer_diameter / 2:
            expected = f"at most half the outer diameter, {self.outer_diameter / 2:g} m"
            raise InvalidInputError("beam wall", self.wall, expected)

    @property
    def area(self) -> float:
        """A [m^2]."""
        return math.pi / 4 * (self.outer_diameter**2 - self._inner**2)

    @property
    def second_moment(self) -> float:
        """I about any diameter [m^4]."""
        return math.pi / 64 * (self.outer_diameter**4 - self._inner**4)

    @property
    def axial(self) -> float:
        """EA [N]."""
        return self.material.elasticity * self.area

    @property
    def bending(self) -> float:
        """EI [N m^2]."""
        return self.material.elasticity * self.second_moment

    @property
    def torsion(self) -> float:
        """GJ [N m^2]."""
        return self.material.rigidity * 2 * self.second_moment

    @property
    def mass_per_length(self) -> float:
        """Rho A [kg/m]."""
        return self.material.density * self.area

    @property
    def _inner(self) -> float:
        return self.outer_diameter - 2 * self.wall
