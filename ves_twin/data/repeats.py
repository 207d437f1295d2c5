"""repeats, unheld: readings that a log repeats from row to row until the next one comes."""

from __future__ import annotations

import numpy as np
from scipy.signal import savgol_filter

from ves_twin.core.types import BoolArray, FloatArray, IntArray

STEPS = 3.0
"""Smallest steps of a column from which on a change is motion and not one count of an encoder."""

FEWEST = 20
"""Readings between two such changes by which the length of repeats is told."""

RESIDUE = 1e-6
"""Share of a usual step below which two levels differ by rounding alone."""

TOGETHER, LEAST = 21, 5
"""Readings in a row whose mean step is theirs: many, to average rounding, and few beside the drift
of a clock; and fewest that tell one."""

LONG = 95.0
"""Percentile of their lengths that is the longest usual one: a clock that is out of step with the
recorder's repeats now 3, now 6 times. What stands longer stands still."""


def repeats(values: FloatArray) -> int:
    """Rows that each reading of a moving column stands for at most; 1 where none is repeated.

    Args:
        values: rows (n,).
    """
    steps = np.abs(np.diff(values))
    changes = np.flatnonzero(steps > 0.0)
    levels = np.diff(np.unique(values))
    levels = levels[levels > RESIDUE * np.median(steps[changes])] if len(changes) else levels
    if len(changes) <= FEWEST or not len(levels):
        return 1
    large = steps[changes] >= STEPS * np.min(levels)
    moving = np.diff(changes)[large[1:] & large[:-1]]
    if len(moving) < FEWEST or np.median(moving) < 2.0:
        return 1
    return int(np.percentile(moving, LONG))


def read_at(values: FloatArray, most: int) -> BoolArray:
    """Which rows (n,) are readings: where it changes, and every so many rows where it stands."""
    rows = np.arange(len(values))
    changes = np.concatenate([[True], np.diff(values) != 0.0])
    since = rows - np.maximum.accumulate(np.where(changes, rows, 0))
    return np.asarray(since % most == 0)


def unheld(values: FloatArray, most: int) -> FloatArray:
    """Values with rows that repeat a reading taken straight between it and the next one.

    A reading that stands for n rows is (n - 1) / 2 of them late in the mean. Readings come at even
    steps, whatever rows first show them: of a sensor of 20 ms in rows of 4 ms they stood for 6, 6
    and 3 rows in turn, and its angle was 15 mrad off by that alone.

    Args:
        values: rows (n,).
        most: rows that a reading stands for.
    """
    if most < 2:
        return values
    read = np.flatnonzero(read_at(values, most))
    return np.asarray(np.interp(np.arange(len(values)), _even(read, values[read]), values[read]))


def _even(read: IntArray, readings: FloatArray) -> FloatArray:
    """Rows of readings with the rounding to whole rows taken out, between standstills."""
    found = np.asarray(read, float)
    same = np.diff(readings, prepend=np.nan) == 0.0
    stands = np.flatnonzero(same[1:] & same[:-1]) + 1  # one alone is where a motion turns round
    for part in np.split(np.arange(len(read)), stands):
        about = min(TOGETHER, (len(part) - 1) // 2 * 2 + 1)
        if about >= LEAST:
            found[part] = savgol_filter(found[part], about, 1)
    return found
