"""spikes: single rows in which a place is far from where it is before and behind."""

from __future__ import annotations

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.data.quality.dropouts import LEVELS, LONGEST, MOST

AWAY = 4.0
"""Times most rows' distance from the middle of their neighbours from which one is far. With it and
ALONE two rows of a swinging beam were found, 8 and 6 degrees off, and one of 80 measured records
had more than three."""

ALONE = 0.3
"""Share of that distance by which the neighbours' own may miss minus half of it, as one row that is
off makes them: a motion that turns or stops does not."""

LARGE = 0.05
"""Share of a column's range below which such a row harms nothing: assumed."""


def spikes(values: FloatArray) -> tuple[int, ...]:
    """Rows far from the middle of both neighbours, in a column that is smooth but for them.

    A force has such rows where parts knock together; a place that was measured has none.

    Args:
        values: of a place (n,).
    """
    x = np.asarray(values, float)
    if not np.isfinite(x).all() or len(np.unique(x)) < LEVELS:
        return ()
    off = np.zeros(len(x))
    off[1:-1] = x[1:-1] - 0.5 * (x[:-2] + x[2:])
    size = np.abs(off)
    if not size.any():
        return ()
    limit = max(AWAY * float(np.percentile(size[size > 0.0], MOST)), LARGE * float(np.ptp(x)))
    before, behind = np.roll(off, 1), np.roll(off, -1)
    alone = [np.abs(beside + 0.5 * off) < ALONE * size for beside in (before, behind)]
    found = np.flatnonzero((size > limit) & alone[0] & alone[1])
    return tuple(found.tolist()) if len(found) < LONGEST * len(x) else ()
