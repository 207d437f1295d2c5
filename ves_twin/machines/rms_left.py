"""rms_left: what a simulation leaves of recordings, nothing fitted to them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ves_twin.core.recording.recording import Recording
from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.model.forward import Channel, Excitation, Forward
from ves_twin.diagnosis.model.grid import AnalysisGrid


def rms_left(
    forward: Forward, recordings: Sequence[Recording], channels: Sequence[Channel], rate: float
) -> FloatArray:
    """Rms error of each channel (c,) at the rows of the analysis; NaN where one diverges.

    Args:
        forward: simulates.
        recordings: that have the channels.
        channels: of it.
        rate: of the analysis [Hz].
    """
    off, names = [], [channel.name for channel in forward.channels]
    at = [names.index(channel.name) for channel in channels]
    for one in recordings:
        fed = Excitation.of(one, forward.drive, rate=rate)
        measured = np.stack([one[c.signal][:, c.column] for c in channels], axis=1)
        rest = measured - forward.simulate(fed, {})[:, at]
        off.append(AnalysisGrid.of(fed.period, rate).reduce(rest))
    return np.asarray(np.sqrt(np.mean(np.square(np.concatenate(off), dtype=float), axis=0)))
