"""unwrapped: an angle that is told within one turn, as the way that was turned."""

from __future__ import annotations

import numpy as np

from ves_twin.core.types import FloatArray

JUMP = 0.7
"""Share of a turn from which on a step between two rows is a wrap: a joint that turned so far
within a row would be seen twice a turn at most."""

SMALL = 0.25
"""Share of a turn that every other step stays below."""

TURN = (0.9, 1.02)
"""Turns that all values of an angle that wraps lie within: it has been near both ends."""


def unwrapped(values: FloatArray, turn: float) -> tuple[FloatArray, int]:
    """An angle without its wraps, and how many there were; as it is, and 0, if it does not wrap.

    Args:
        values: of even or uneven rows (n,).
        turn: what a turn is in their unit.
    """
    steps = np.abs(np.diff(values)) / turn
    wraps = steps > JUMP
    span = float(np.ptp(values)) / turn if len(values) else 0.0
    if not np.any(wraps) or np.max(steps[~wraps], initial=0.0) > SMALL:
        return values, 0
    if not TURN[0] <= span <= TURN[1]:
        return values, 0
    return np.asarray(np.unwrap(values, period=turn)), int(np.count_nonzero(wraps))
