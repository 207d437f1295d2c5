"""added: a reading with something added to one column."""

from __future__ import annotations

from ves_twin.core.types import FloatArray


def added(reading: FloatArray, column: int, change: FloatArray | float) -> FloatArray:
    """A reading (n, w) with a change, (n,) or constant, added to a column, counted from 0."""
    reading = reading.copy()
    reading[:, column] += change
    return reading
