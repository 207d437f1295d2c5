"""Size: the one number of a kind of effect: its name, unit and range at a place."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from ves_twin.effects.magnitude import Magnitude, Sign
from ves_twin.machines.mjcf.place import Place

LEAST = 0.001
"""Smallest size of interest, as a share of the largest, where a kind says nothing else."""

Length = float | Callable[[Place], float]
"""A number, or what makes one of a place's typical sizes."""


@dataclass(frozen=True)
class Size:
    """One row of the table of kinds.

    Attributes:
        name: field of the effect.
        unit: SI; of a slide and of a hinge, where they differ; "" is the unit of the signal.
        largest: plausible size.
        smallest: size of interest; LEAST of the largest if None.
        sign: directions that are physical.
    """

    name: str
    unit: str | tuple[str, str]
    largest: Length
    smallest: Length | None = None
    sign: Sign = Sign.BOTH

    def at(self, place: Place) -> Magnitude:
        """The size at a place, absent by declaration (sd 0)."""
        unit = self.unit if isinstance(self.unit, str) else place.pick(*self.unit)
        largest = _number(self.largest, place)
        smallest = LEAST * largest if self.smallest is None else _number(self.smallest, place)
        return Magnitude(self.name, unit or place.unit, 0.0, smallest, largest, self.sign)


def _number(length: Length, place: Place) -> float:
    return length(place) if callable(length) else length
