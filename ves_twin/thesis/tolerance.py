"""Tolerance: what values must meet; the same comparison for every claim."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Annotated

import numpy as np
from pydantic import BeforeValidator, Field

from ves_twin.scenario.fields import named

Number = Annotated[float, Field(strict=True)]
Numbers = Annotated[
    tuple[Number, ...], BeforeValidator(lambda v: v if isinstance(v, list | tuple) else (v,))
]
"""Of a file: a number, or a list of numbers."""

ROUND_OFF = 1e-12
"""Relative difference that `exact` leaves to double precision."""


class Comparison(StrEnum):
    """How values are compared with what is expected."""

    EXACT = "exact"
    ABSOLUTE = "absolute"
    RELATIVE = "relative"
    INTERVAL = "interval"
    AT_MOST = "at_most"
    AT_LEAST = "at_least"
    EVENT = "event"


_DEVIATIONS = (Comparison.EXACT, Comparison.ABSOLUTE, Comparison.RELATIVE)


@dataclass(frozen=True)
class Tolerance:
    """One requirement; limits are a single number for all values or one for each.

    Attributes:
        kind: how values are compared.
        limit: largest deviation (absolute, or relative to the expected magnitude), or bound.
        low: lower end of an interval.
        high: upper end of an interval.
    """

    kind: Annotated[Comparison, named("comparison", [kind.value for kind in Comparison])]
    limit: Numbers = ()
    low: Number = -np.inf
    high: Number = np.inf

    def met(self, values: Sequence[float], expected: Sequence[float], holds: bool | None) -> bool:
        """Whether values meet the requirement.

        Args:
            values: what the twin gives (n,).
            expected: what is expected (n,); only for exact, absolute and relative.
            holds: whether a condition beside the values came out; must be True for an event.

        Returns:
            False also where values are missing, not finite, or of another number.
        """
        if self.kind is Comparison.EVENT:
            return holds is True
        found = np.asarray(values, dtype=float)
        if found.size == 0 or not np.all(np.isfinite(found)) or holds is False:
            return False
        bounds = self._bounds(np.asarray(expected, dtype=float))
        if bounds is None or any(b.size not in (1, found.size) for b in bounds):
            return False
        if self.kind in _DEVIATIONS and len(expected) != found.size:
            return False
        return bool(np.all(found >= bounds[0]) and np.all(found <= bounds[1]))

    def words(self, unit: str) -> str:
        """The requirement as a person reads it; `unit` is that of the values."""
        limit = ", ".join(f"{bound:g}" for bound in dict.fromkeys(self.limit))
        tail = "" if unit == "1" or "," in unit else f" {unit}"
        return {
            Comparison.EXACT: "exact",
            Comparison.ABSOLUTE: f"+-{limit}{tail}",
            Comparison.RELATIVE: f"+-{', '.join(f'{100 * b:g}' for b in self.limit)} %",
            Comparison.INTERVAL: f"{self.low:g} to {self.high:g}{tail}",
            Comparison.AT_MOST: f"<= {limit}{tail}",
            Comparison.AT_LEAST: f">= {limit}{tail}",
            Comparison.EVENT: "it happens",
        }[self.kind]

    def _bounds(
        self, expected: np.ndarray[tuple[int, ...], np.dtype[np.float64]]
    ) -> tuple[np.ndarray, np.ndarray] | None:
        """Lowest and highest value allowed; None where something to compare with is missing."""
        limit, infinite = np.asarray(self.limit, dtype=float), np.array([np.inf])
        if self.kind is Comparison.INTERVAL:
            return np.array([self.low]), np.array([self.high])
        if self.kind is Comparison.AT_MOST:
            return -infinite, limit
        if self.kind is Comparison.AT_LEAST:
            return limit, infinite
        if expected.size == 0:
            return None
        if self.kind is Comparison.EXACT:
            limit = np.array([ROUND_OFF])
        if limit.size not in (1, expected.size):
            return None
        spread = limit if self.kind is Comparison.ABSOLUTE else limit * np.abs(expected)
        return expected - spread, expected + spread
