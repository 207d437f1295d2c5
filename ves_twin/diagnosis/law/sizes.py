"""Sizes: closed forms side by side, each with its size alone open, for a linear look."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.law.candidate import Candidate, Closed
from ves_twin.effects.law import Law


@dataclass(frozen=True)
class Sizes(Candidate):
    """A sum of closed forms of one variable, whose inner numbers stay as they are.

    Attributes:
        entries: one form each.
    """

    entries: tuple[Closed, ...]

    @property
    def start(self) -> FloatArray:
        """None of them."""
        return np.zeros(len(self.entries))

    @property
    def sd(self) -> FloatArray:
        """As each has it."""
        return np.array([entry.sd[0] for entry in self.entries])

    @property
    def label(self) -> str:
        """Apart from a table of the same variable."""
        return f"{super().label}: sizes of {len(self.entries)} forms"

    def law(self, numbers: FloatArray) -> Law:
        """A table of the sum."""
        at_work = np.flatnonzero(numbers)
        laws = [
            self.entries[n].law(np.array([numbers[n], *self.entries[n].inner[0]]))
            for n in (at_work if len(at_work) else [0])
        ]
        x = np.unique(np.concatenate([law.knots[0] for law in laws]))
        total = sum((law.at(x) for law in laws), np.zeros(len(x)))
        return replace(laws[0], knots=(tuple(x.tolist()),), values=tuple(total.tolist()), form="")
