"""Shapes: how a size can change over days: once, or steadily from a date on."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property

import numpy as np

from ves_twin.core.types import FloatArray

DATES = 41
"""Dates between the first day and the last but two from which a ramp may begin."""


class Kind(StrEnum):
    """A step between two recordings, or a ramp from a date on, also from before the first."""

    STEP = "step"
    RAMP = "ramp"


@dataclass(frozen=True)
class Shapes:
    """Columns of every change that is looked for.

    Attributes:
        days: dates of the recordings, rising [days] (n,).
    """

    days: FloatArray

    @cached_property
    def stops(self) -> FloatArray:
        """Dates without repeats."""
        return np.unique(self.days)

    @cached_property
    def steps(self) -> FloatArray:
        """First date that has the change, of each step."""
        return self.stops[1:]

    @cached_property
    def ramps(self) -> FloatArray:
        """Date from which each ramp rises; two later dates at least are on it."""
        if len(self.stops) < 3:
            return np.zeros(0)
        return np.linspace(self.stops[0], self.stops[-3], DATES if len(self.stops) > 3 else 1)

    @cached_property
    def columns(self) -> FloatArray:
        """0 to 1 for each step, then 0 to the days since for each ramp (m, n)."""
        steps = (self.days[None] >= self.steps[:, None]).astype(float)
        ramps = np.maximum(self.days[None] - self.ramps[:, None], 0.0)
        return np.concatenate([steps, ramps])

    def rows(self, kind: Kind) -> slice:
        """Columns of a kind."""
        count = len(self.steps)
        return slice(0, count) if kind is Kind.STEP else slice(count, count + len(self.ramps))
