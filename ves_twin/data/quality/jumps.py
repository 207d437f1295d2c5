"""jumps: rows between which a place is another one at once, and stays so."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.data.quality.dropouts import JUMP, LEVELS, LONGEST, MOST

BESIDE = 5
"""Rows to either side over which a place is as it is before, and behind, its jump."""

STAYS = 0.8
"""Share of a jump by which the place is another one over those rows."""

MANY = 5
"""Jumps from which on that is how a column goes: assumed."""

RESTS = 0.02
"""Share of a jump by which a place that rests moves in those rows at most."""

ASKED = 0.1
"""Share of a command's range by which it changes there where it asks for a move: assumed."""

STEPS = 2
"""Values that it has there then."""


def jumps(
    values: FloatArray, time: FloatArray, commands: Sequence[FloatArray] = ()
) -> tuple[int, ...]:
    """Rows behind which a column jumps in one step, and stays where it came to.

    No mechanism does that: two runs were put behind each other, or a counter was set anew. A step
    over a gap in the clock counts by the rows that it lacks. Where a place rests before and behind
    a jump, a slow log may have missed the move: not if a command asks for it, or it does so again.

    Args:
        values: of a place (n,).
        time: of its rows (n,).
        commands: what may have asked for a move (n,) each.
    """
    x = np.asarray(values, float)
    if len(x) <= 2 * BESIDE or not np.isfinite(x).all() or len(np.unique(x)) < LEVELS:
        return ()
    steps = np.diff(x)
    period = max(float(np.median(np.diff(time))), 1e-300)
    size = np.abs(steps) / np.maximum(np.diff(time) / period, 1.0)
    limit = JUMP * float(np.percentile(size[size > 0.0], MOST))
    found, moves = [], 0
    for k in np.flatnonzero(size > limit).tolist():
        before, behind = x[max(k + 1 - BESIDE, 0) : k + 1], x[k + 1 : k + 1 + BESIDE]
        if min(len(before), len(behind)) < BESIDE:
            continue
        other = abs(float(np.median(behind) - np.median(before))) > STAYS * abs(steps[k])
        beside = max(np.ptp(before), np.ptp(behind)) * JUMP < BESIDE * abs(steps[k])
        span, near = max(int(LONGEST * len(x)), BESIDE), (1.0 - STAYS) * abs(steps[k])
        back = np.any(np.abs(x[k + 1 : k + 1 + span] - x[k]) < near)
        was = np.any(np.abs(x[max(k + 1 - span, 0) : k + 1] - x[k + 1]) < near)
        if not (other and beside) or back or was:
            continue
        if max(np.ptp(before), np.ptp(behind)) < RESTS * abs(steps[k]):
            moves += 1
            if any(_asks(command, k) for command in commands):
                continue
        found.append(k)
    return tuple(found) if len(found) < MANY and moves < 2 else ()


def _asks(command: FloatArray, row: int) -> bool:
    """Whether a command steps about a row, from one value to another."""
    near = command[max(row + 1 - BESIDE, 0) : row + 1 + BESIDE]
    return len(np.unique(near)) == STEPS and bool(np.ptp(near) > ASKED * np.ptp(command))
