"""even_clock: a recording on an even clock from t = 0, with NaN where it holds nothing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.recording import Recording
from ves_twin.core.types import FloatArray

FEWEST = 64
"""Rows below which neither bands nor stretches of time mean anything."""

LONGEST_HOLE = 0.25
"""Set-points may be missing for so long [s]; over more, what the rig was told is guesswork."""


WAKE = 1.0
"""Time after a hole in which the rig may still show what was guessed in it [s]: a dozen time
constants of the legs at 12.6 /s (thesis 5.2)."""


def even_clock(recording: Recording, drive: Sequence[str]) -> Recording:
    """The recording with rows at every median period, shifted to begin at t = 0.

    Rows go to the nearest tick of the even clock. Measurements that are missing stay NaN;
    set-points are drawn smoothly (cubic) across short holes, and what was measured there and
    for a while after is left out, since nobody knows what the rig was told.

    Args:
        recording: rows may be missing and values be NaN.
        drive: signals that will be fed in.

    Raises:
        InvalidInputError: too few rows, or set-points missing for longer than LONGEST_HOLE.
    """
    if len(recording) < FEWEST:
        raise InvalidInputError("rows of the recording", len(recording), f"at least {FEWEST}")
    period = float(np.median(np.diff(recording.time)))
    place = np.round((recording.time - recording.time[0]) / period).astype(np.int64)
    place, first = np.unique(place, return_index=True)
    count = int(place[-1]) + 1
    if count > 4 * len(recording):
        raise InvalidInputError(
            "recording",
            f"rows for {len(place)} of {count} periods of {period:.4g} s",
            "at least a quarter of them",
        )
    exact = np.array_equal(place, np.arange(count)) and len(place) == len(recording)
    even = np.arange(count, dtype=np.float64) * period
    time = np.asarray(recording.time - recording.time[0] if exact else even, np.float64)
    signals, wake = {}, np.zeros(count, dtype=bool)
    for name, values in recording.signals.items():
        rows = np.full((count, values.shape[1]), np.nan)
        rows[place] = values[first]
        if name in drive:
            wake |= _wake(rows, period)
            rows = _bridged(rows, period, name)
        signals[name] = rows
    for name, rows in signals.items():
        if name not in drive:
            rows[wake] = np.nan
    return replace(recording, time=time, signals=signals)


def holes(recording: Recording, drive: Sequence[str]) -> int:
    """Rows of the set-points that hold no number, for the notes of a page."""
    bad = [~np.isfinite(recording[name]).all(axis=1) for name in drive]
    return int(np.count_nonzero(np.any(bad, axis=0)))


def _bridged(values: FloatArray, period: float, name: str) -> FloatArray:
    bad = ~np.isfinite(values).all(axis=1)
    if not bad.any():
        return values
    edges = np.flatnonzero(np.diff(np.concatenate([[0], bad.astype(int), [0]])))
    longest = int((edges[1::2] - edges[::2]).max()) * period
    if longest > LONGEST_HOLE or bad.all():
        raise InvalidInputError(
            f"{name} (what the rig was told)",
            f"no number for {longest:.2f} s",
            f"holes of at most {LONGEST_HOLE} s; choose another window",
        )
    at, good = np.arange(len(values)), ~bad
    return np.asarray(CubicSpline(at[good], values[good])(at))


def _wake(values: FloatArray, period: float) -> NDArray[np.bool_]:
    """Rows whose set-points are guessed, and those in which the rig still shows the guess."""
    bad = np.any(~np.isfinite(values), axis=1, keepdims=False)
    after = np.convolve(bad, np.ones(1 + round(WAKE / period)))[: len(bad)]
    return np.asarray(after > 0.5)
