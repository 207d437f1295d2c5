"""alternate: every second stretch of a recording for fitting, the others held out."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.recording import POSES, Recording
from ves_twin.core.types import BoolArray, FloatArray
from ves_twin.diagnosis.record.preprocess import fewest_rows

ROUNDING = 1e-6
"""Share of a stretch by which stamps may be early for rounding."""

LEFT_OUT = -1
"""Number of the stretch of rows that belong to none."""


def alternate(
    recording: Recording, length: float, rate: float | None = None
) -> tuple[list[Recording], list[Recording]]:
    """Stretches 1, 3, 5, ... and stretches 2, 4, 6, ... of a recording.

    Args:
        recording: cut by its clock.
        length: of a stretch [s], or number of poses.
        rate: of the analysis for which each stretch of a record in time must have rows enough [Hz];
            None: as they come.

    Returns:
        Fitted and held out; of poses at rest one recording each, since order does not matter to
        them, of a record in time one for each stretch, a last one below half a length left out. One
        with too few rows is joined to the one before; the two of a recording are made equal.

    Raises:
        InvalidInputError: fewer than two stretches, or too few rows in one.
    """
    start, stop = float(recording.time[0]), float(recording.time[-1])
    count = int(np.ceil((stop - start) / length - 0.5)) if length > 0 else 0
    if recording.info.log == POSES:
        count = int(np.ceil((stop - start + 1.0) / length)) if length > 0 else 0
    if count < 2:
        span = f"a stretch of {length:g} in {stop - start:g}"
        raise InvalidInputError("stretches to hold out", span, "two stretches or more")
    ends = (recording.time - start) / length + ROUNDING
    number = np.minimum(np.floor(ends), count - 1)
    if recording.info.log == POSES:
        return [_rows(recording, number % 2 == 0)], [_rows(recording, number % 2 == 1)]
    number[recording.time - start >= count * length] = LEFT_OUT
    fewest = fewest_rows(_period(recording), rate) if rate else 0
    number = _joined(number, count, fewest)
    parts = [_rows(recording, number == k) for k in range(int(np.max(number)) + 1)]
    if rate:
        _check_rows(recording, parts, rate)
    return parts[0::2], parts[1::2]


def _joined(number: FloatArray, count: int, fewest: int) -> FloatArray:
    """Stretch of each row (n,) with a last one of too few rows joined to the one before."""
    if np.count_nonzero(number == count - 1) >= fewest:
        return number
    if count > 2:
        return np.minimum(number, count - 2)
    if len(number) < 2 * fewest:
        return number
    return np.floor(2.0 * np.arange(len(number)) / len(number))


def _check_rows(recording: Recording, parts: Sequence[Recording], rate: float) -> None:
    """Refuse stretches of too few rows, and say which length has enough, if one has."""
    short = min(parts, key=lambda part: len(part.time))
    rows, period = len(recording.time), _period(recording)
    fewest = fewest_rows(period, rate)
    if len(short.time) >= fewest:
        return
    what = f"rows of {recording.info.scenario or 'a recording'} from"
    what += f" {short.time[0]:.2f} to {short.time[-1]:.2f} s, a stretch of --alternate"
    length = enough(recording, rate)
    expected = f"at least {fewest}: --alternate {length:g}"
    if rows < 2 * fewest or rows * period < 1.5 * length:
        both = f"two stretches take {2 * fewest * period:.2f} s, and it has {rows * period:.2f} s"
        expected = f"at least {fewest}: {both}, so hold out another recording (--held-out)"
    raise InvalidInputError(what, len(short.time), expected)


def enough(recording: Recording, rate: float) -> float:
    """The shortest length of stretches [s], of two digits, of which all have rows enough."""
    least = fewest_rows(_period(recording), rate) * _period(recording) * (1.0 - ROUNDING)
    digit = 10.0 ** (np.floor(np.log10(least)) - 1.0)
    return float(f"{np.ceil(least / digit) * digit:.2g}")


def _period(recording: Recording) -> float:
    return float(np.ptp(recording.time)) / (len(recording.time) - 1)


def _rows(recording: Recording, rows: BoolArray) -> Recording:
    signals = {name: values[rows] for name, values in recording.signals.items()}
    return Recording(recording.time[rows], signals, recording.info)
