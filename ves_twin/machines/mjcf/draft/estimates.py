"""noise_of, rest_of, typical_sizes: what a log tells of noise and of sizes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.signal import detrend, spectrogram

from ves_twin.core.types import FloatArray

REST, FEWEST = 0.2, 50
"""Least length of a stretch at rest [s] and its rows."""

STILL = 6.0
"""Noises within which positions stay in a stretch at rest: peak to peak of white noise."""

TYPICAL = 95.0
"""Percentile of a size that is typical: peaks are left to single rows."""


SMOOTH, ASSUMED = 1e-3, 5e-3
"""Noise of a measured effort, as a share of its rms about its mean, below which it was low-passed;
and what is assumed then. Drives of three measured arms have 1 to 10 %; torque sensors are of class
0.1 to 0.5."""

DWELLS = 0.02
"""Share of a column's range within which it stays where it is in a stretch: assumed."""

LEVELS = 5
"""Values up to which a column is switched, and their steps are no rounding: assumed."""

WHOLE = 0.02
"""Steps by which differences of a column that is rounded may miss whole ones."""

LOW_PASSED = "low-passed, so assumed: half a per cent of its size"
"""How such a noise was told."""


def noise_of(
    values: FloatArray,
    period: float,
    rest: slice | None,
    command: bool = False,
    effort: bool = False,
) -> tuple[float, str]:
    """Sd of one row, as of white noise, and how it was told.

    At rest the scatter about a straight line; else the power in the highest octave as if it were
    that of all, no less than rounding to the smallest step makes, step / sqrt(12). A command has
    rounding alone, or a thousandth of its size where it is not rounded, or is switched between few
    LEVELS: what is fast in it was put out so. A measured effort that has next to nothing in its
    highest octave was low-passed, and its noise with it: ASSUMED of its size.

    Args:
        values: of a column.
        period: of its rows [s].
        rest: rows in which nothing moves, if there are any.
        command: whether a controller put the column out.
        effort: whether it was measured on a drive.
    """
    levels = np.unique(values)
    steps = np.abs(np.diff(levels))
    switched = command and len(levels) <= LEVELS
    rounding = 0.0 if switched or not len(steps) else float(np.min(steps)) / np.sqrt(12.0)
    if command and len(levels) > 1:
        least = float(np.min(steps))
        if rounding > 0.0 and np.max(np.abs(steps / least - np.round(steps / least))) < WHOLE:
            return rounding, "rounding: a command has no other"
        return SMOOTH * float(np.std(values)), "a thousandth of its size: a command has none"
    if rest is not None and float(np.ptp(values[rest])) > 0.0:
        return max(float(np.std(detrend(values[rest]))), rounding), "scatter at rest"
    level = _fast(values, period)
    sd, size = max(float(np.sqrt(level * 0.5 / period)), rounding), float(np.std(values))
    if effort and sd < SMOOTH * size:
        return ASSUMED * size, LOW_PASSED
    return sd, "highest octave"


def _fast(values: FloatArray, period: float) -> float:
    """Power per Hz in the highest octave, in the median of the stretches in which a column moves.

    One jump is no noise, and noise is not what is left of it where a machine dwells.
    """
    rows = min(len(values) // 4, 1024)
    told = {"nperseg": rows, "noverlap": rows // 2, "detrend": "linear", "window": "hann"}
    frequency, _, power = spectrogram(values - values.mean(), 1.0 / period, **told)
    starts = np.arange(power.shape[1]) * (rows - rows // 2)
    moves = np.array([np.ptp(values[k : k + rows]) for k in starts]) > DWELLS * np.ptp(values)
    kept = power[:, moves] if np.count_nonzero(moves) > 1 else power
    level = np.median(kept, axis=1)[frequency >= 0.25 / period]
    # the median of n exponential draws is below their mean
    pairs = 2.0 * np.arange(1, (kept.shape[1] - 1) // 2 + 1)
    return float(np.median(level) / (1.0 + np.sum(1.0 / (pairs + 1.0) - 1.0 / pairs)))


def rest_of(positions: Sequence[FloatArray], period: float) -> slice | None:
    """The longest stretch at the begin of a log in which nothing moves; None where it moves."""
    last = len(positions[0]) if positions else 0
    for values in positions:
        noise, _ = noise_of(values, period, None)
        low, high = np.minimum.accumulate(values), np.maximum.accumulate(values)
        moved = np.flatnonzero(high - low > STILL * noise)
        last = min(last, int(moved[0]) if len(moved) else len(values))
    last -= last // 5  # where it begins to move it is within the noise still
    return slice(0, last) if last >= max(FEWEST, REST / period) else None


def typical(values: FloatArray) -> float:
    """Size that a column has, to two digits."""
    return two_digits(float(np.percentile(np.abs(values), TYPICAL)))


def travel(values: FloatArray) -> float:
    """Distance that a column goes to and fro, without the outermost rows, to two digits."""
    low, high = np.percentile(values, (100.0 - TYPICAL, TYPICAL))
    return two_digits(float(high - low))


def two_digits(value: float) -> float:
    """A number as a person would write it."""
    return float(f"{value:.2g}")
