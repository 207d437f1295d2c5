"""compared_stretch: a recording cut so that only a stretch of it is compared."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.recording import Recording


def compared_stretch(
    recording: Recording, start: float, stop: float, drive: Collection[str], name: str
) -> Recording:
    """The recording up to `stop`, without measurements before `start`.

    What is fed in stays from the first row on: what comes before the stretch makes its state.

    Args:
        recording: any.
        start: of the stretch [s], from the first row.
        stop: its end [s].
        drive: signals that are fed in.
        name: of the recording, for messages.

    Raises:
        InvalidInputError: fewer than two rows in the stretch.
    """
    time = recording.time - recording.time[0]
    inside = time < stop
    if np.count_nonzero(inside & (time >= start)) < 2:
        came = f"nothing between {start:g} and {stop:g} s"
        raise InvalidInputError(f"window of {name}", came, f"some of 0 to {time[-1]:g} s")
    signals = {n: values[inside].copy() for n, values in recording.signals.items()}
    for signal, values in signals.items():
        if signal not in drive:
            values[time[inside] < start] = np.nan
    return replace(recording, time=recording.time[inside], signals=signals)
