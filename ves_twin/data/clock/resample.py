"""resample: one channel from its own rows onto those of a recording."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.signal import firwin, kaiserord, oaconvolve

from ves_twin.core.signals import Role
from ves_twin.core.types import BoolArray, FloatArray
from ves_twin.data.clock.clock_report import GAP
from ves_twin.data.mapping.import_map import Gaps, Way

RIPPLE = 60.0
"""Stop band of the low-pass [dB]: a thousandth, below the noise of any channel here."""

FLAT, STOP = 0.4, 0.5
"""Ends of the pass band and of the transition, in rates of the rows: nothing folds back."""

SAME = 1e-3
"""Rates that differ by less count as one."""

LATE = 0.1
"""Part of a row, or of the value's own period where that is shorter, by which the stamp of a held
value may be late: with none, jitter of any size takes every second value from the row before."""


@dataclass(frozen=True)
class Resampled:
    """A channel on the rows of a recording.

    Attributes:
        values: NaN where there was nothing (n,).
        how: what was done, in words.
        held: time between its changes [s]; 0 where it is not held.
    """

    values: FloatArray
    how: str
    held: float


def resample(
    values: FloatArray,
    time: FloatArray,
    period: float,
    rows: FloatArray,
    step: float,
    way: Way,
    role: Role,
    gaps: Gaps,
) -> Resampled:
    """Values of a channel at the rows.

    Args:
        values: on the channel's own rows (k,), NaN where missing.
        time: of those rows, increasing [s] (k,).
        period: usual step of `time` [s].
        rows: times of the recording's rows [s] (n,).
        step: their usual step [s].
        way: how; AUTO chooses by role and rate.
        role: a command is held, as the rig holds it.
        gaps: what stands where nothing was recorded for more than 1.5 periods.
    """
    place = np.minimum(np.searchsorted(time, rows), len(time) - 1)
    own = way in (Way.AUTO, Way.HOLD) and abs(period / step - 1.0) < SAME
    if own and np.array_equal(time[place], rows):
        filled = _hold_nan(values) if gaps is Gaps.HOLD else values
        return Resampled(filled[place], "as recorded", 0.0)
    good = np.isfinite(values)
    if np.count_nonzero(good) < 2:
        return Resampled(np.full(len(rows), np.nan), "no numbers", 0.0)
    values, time = values[good], time[good]
    chosen = _chosen(way, role, period, step)
    if chosen is Way.HOLD:
        found = Resampled(
            _newest(values, time, rows, min(step, period)),
            "newest value held",
            period if period > step else 0.0,
        )
    elif chosen is Way.LINEAR:
        found = Resampled(np.asarray(np.interp(rows, time, values)), "straight between rows", 0.0)
    else:
        found = _filtered(values, time, period, rows, step)
    empty = _in_gap(time, period, rows, chosen is Way.HOLD)
    if gaps is Gaps.HOLD:
        after = rows >= time[0]
        fill = empty & after
        found.values[fill] = _newest(values, time, rows[fill], min(step, period))
        empty &= ~after
    found.values[empty] = np.nan
    return found


def _chosen(way: Way, role: Role, period: float, step: float) -> Way:
    if way is not Way.AUTO:
        return way
    if role is Role.COMMAND or period > step * (1.0 + SAME):
        return Way.HOLD
    return Way.FILTER if period < step * (1.0 - SAME) else Way.LINEAR


def _filtered(
    values: FloatArray, time: FloatArray, period: float, rows: FloatArray, step: float
) -> Resampled:
    """A zero-phase low-pass on an even grid, then a cubic spline."""
    even = time[0] + np.arange(round((time[-1] - time[0]) / period) + 1) * period
    on_grid = np.interp(even, time, values)
    own, asked = 1.0 / period, 1.0 / step
    if own > asked * (1.0 + SAME):
        taps, beta = kaiserord(RIPPLE, (STOP - FLAT) * asked / (0.5 * own))
        taps |= 1
        window = firwin(taps, 0.5 * (FLAT + STOP) * asked, window=("kaiser", beta), fs=own)
        half = taps // 2
        mirrored = np.pad(on_grid, half, mode="reflect", reflect_type="odd")
        on_grid = oaconvolve(mirrored, window, mode="valid")
        how = (
            f"{own:.4g} Hz to {asked:.4g} Hz by a zero-phase FIR low-pass (Kaiser, {taps} taps,"
            f" {RIPPLE:.0f} dB): flat to {FLAT * asked:.3g} Hz, nothing above {STOP * asked:.3g} Hz"
        )
    else:
        how = "cubic spline between rows; no low-pass, it is not faster than the rows"
    inside = np.clip(rows, even[0], even[-1])
    return Resampled(np.asarray(CubicSpline(even, on_grid)(inside)), how, 0.0)


def _newest(values: FloatArray, time: FloatArray, rows: FloatArray, step: float) -> FloatArray:
    """The newest value at each row; a stamp that is late by LATE does not make it older."""
    place = np.searchsorted(time, rows + LATE * step, "right") - 1
    return np.asarray(values[np.maximum(place, 0)])


def _in_gap(time: FloatArray, period: float, rows: FloatArray, held: bool) -> BoolArray:
    """Rows in a step of more than 1.5 periods, or before the begin or after the end."""
    slack = 0.25 * period
    after = np.searchsorted(time, rows + 1e-6, "right")
    last = time[np.maximum(after - 1, 0)]
    upcoming = time[np.minimum(after, len(time) - 1)]
    wide = (upcoming - last > GAP * period) & (rows - last > (period if held else slack))
    wide &= (upcoming - rows > slack) | held
    ended = rows > time[-1] + GAP * period
    return np.asarray(wide | (rows < time[0] - slack) | ended)


def _hold_nan(values: FloatArray) -> FloatArray:
    place = np.where(np.isfinite(values), np.arange(len(values)), -1)
    place = np.maximum.accumulate(place)
    return np.asarray(np.where(place >= 0, values[np.maximum(place, 0)], np.nan))
