"""dropouts: rows in which a reading stands at one value far from those around it."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from ves_twin.core.types import FloatArray

JUMP = 10.0
"""Times most steps of a column, and the steps beside it, from which on a step is a jump."""

MOST = 95.0
"""Percentile of the steps that is called most of them."""

BACK = 0.5
"""Share of a jump within which the rows behind it are where those before it were."""

LONGEST = 0.05
"""Share of a record up to which stretches are dropouts, not another state."""

FEWEST = 3
"""Rows above which the first and the last one need not be at that value."""

LEVELS = 20
"""Values that a column has at least: what is switched jumps and stands by its nature."""


def dropouts(values: FloatArray) -> tuple[slice, ...]:
    """Stretches of rows that one jump begins and an opposite one ends, at one value throughout.

    A sensor that lost its signal reads so (zero, or an end of its range). A machine that moves fast
    takes more than one row to get there.

    Args:
        values: of one column (n,); rows without a number count as those before them.
    """
    x = np.asarray(values, float)
    known = np.isfinite(x)
    if not known.any() or len(np.unique(x[known])) < LEVELS:
        return ()
    last = np.maximum.accumulate(np.where(known, np.arange(len(x)), np.argmax(known)))
    x = x[last]
    size = np.abs(np.diff(x))
    limit = JUMP * float(np.percentile(size[size > 0.0], MOST))
    found = []
    for (begin, there), (leaves, back) in pairwise(_jumps(x, limit)):
        away, returns = x[there] - x[begin], x[back] - x[leaves]
        beside = [*size[max(begin - 1, 0) : begin], *size[back : back + 1]]
        lone = all(JUMP * step < min(abs(away), abs(returns)) for step in beside)
        same = abs(away + returns) < BACK * abs(away)
        short = leaves - there < LONGEST * len(x)
        if lone and same and short and _stands(x[there : leaves + 1]):
            found.append(slice(begin + 1, back))
    rows = sum(one.stop - one.start for one in found)
    return tuple(found) if rows <= LONGEST * len(x) else ()


def _stands(rows: FloatArray) -> bool:
    """Whether a reading is at one value: twice at least, or once at zero.

    The first and the last row may lie between two of the log, where it was read at even steps.
    """
    inner = rows[1:-1] if len(rows) > FEWEST else rows
    return bool(np.ptp(inner) == 0.0 and (len(inner) > 1 or inner[0] == 0.0))


def _jumps(x: FloatArray, limit: float) -> list[tuple[int, int]]:
    """Rows before and behind each jump, which may take a row between."""
    steps, found = np.diff(x), list[tuple[int, int]]()
    for k in np.flatnonzero(np.abs(steps) > limit).tolist():
        if found and found[-1] == (k - 1, k) and steps[k - 1] * steps[k] > 0.0:
            found[-1] = (k - 1, k + 1)
        else:
            found.append((k, k + 1))
    return found
