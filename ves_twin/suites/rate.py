"""Rate: how often, of how many, with its interval."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeVar

from scipy.stats import binomtest

Case = TypeVar("Case")


@dataclass(frozen=True)
class Rate:
    """How often, of how many, with the 95 % Wilson interval."""

    hits: int
    of: int

    @staticmethod
    def over(cases: Sequence[Case], hit: Callable[[Case], bool]) -> Rate:
        """Of the cases that are hits."""
        return Rate(sum(hit(case) for case in cases), len(cases))

    @property
    def interval(self) -> tuple[float, float]:
        """95 % (Wilson); 0 to 1 of none."""
        if self.of == 0:
            return 0.0, 1.0
        found = binomtest(self.hits, self.of).proportion_ci(0.95, method="wilson")
        return float(found.low), float(found.high)

    def __str__(self) -> str:
        low, high = self.interval
        share = f"{self.hits / self.of:.0%}" if self.of else "-"
        return f"{self.hits} of {self.of} ({share}; {low:.0%} to {high:.0%})"
