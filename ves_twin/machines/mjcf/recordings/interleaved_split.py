"""alternate: every second stretch of a recording for fitting, the others held out."""

from __future__ import annotations

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.recording import POSES, Recording
from ves_twin.core.types import BoolArray


def alternate(recording: Recording, length: float) -> tuple[list[Recording], list[Recording]]:
    """Stretches 1, 3, 5, ... and stretches 2, 4, 6, ... of a recording.

    Args:
        recording: cut by its clock.
        length: of a stretch [s], or number of poses.

    Returns:
        Fitted and held out; of poses at rest one recording each, since order does not matter to
        them, of a record in time one for each stretch, a last one below half a length left out.

    Raises:
        InvalidInputError: fewer than two stretches.
    """
    start, stop = float(recording.time[0]), float(recording.time[-1])
    count = int(np.ceil((stop - start) / length - 0.5)) if length > 0 else 0
    if recording.info.log == POSES:
        count = int(np.ceil((stop - start + 1.0) / length)) if length > 0 else 0
    if count < 2:
        span = f"a stretch of {length:g} in {stop - start:g}"
        raise InvalidInputError("stretches to hold out", span, "two stretches or more")
    number = np.minimum((recording.time - start) // length, count - 1)
    if recording.info.log == POSES:
        return [_rows(recording, number % 2 == 0)], [_rows(recording, number % 2 == 1)]
    whole = (recording.time - start) < count * length
    parts = [_rows(recording, (number == k) & whole) for k in range(count)]
    return parts[0::2], parts[1::2]


def _rows(recording: Recording, rows: BoolArray) -> Recording:
    signals = {name: values[rows] for name, values in recording.signals.items()}
    return Recording(recording.time[rows], signals, recording.info)
