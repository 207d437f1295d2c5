"""Magnitude: one size of an effect: unit, bounds, sign, and what commissioning leaves open."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Sign(StrEnum):
    """Which signs a magnitude can have."""

    BOTH = "both"
    POSITIVE = "positive"
    NEGATIVE = "negative"


@dataclass(frozen=True)
class Magnitude:
    """One size of an effect; zero is always "no effect".

    Attributes:
        name: field of the effect, for instance "offset".
        unit: SI unit.
        sd: what commissioning leaves open on a healthy rig, one sigma.
        smallest: smallest size of interest.
        largest: largest size that is plausible, and the bound of the field.
        sign: which signs it can have.
        component: whether it is one of a vector, so that at zero the others may say all.
    """

    name: str
    unit: str
    sd: float
    smallest: float
    largest: float
    sign: Sign = Sign.BOTH
    component: bool = False

    @property
    def low(self) -> float:
        """Lower bound."""
        return 0.0 if self.sign is Sign.POSITIVE else -self.largest

    @property
    def high(self) -> float:
        """Upper bound."""
        return 0.0 if self.sign is Sign.NEGATIVE else self.largest
