"""rms_left: what a simulation leaves of recordings, nothing fitted to them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ves_twin.core.recording.recording import Recording
from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.model.forward import Channel, Excitation, Forward
from ves_twin.diagnosis.model.grid import AnalysisGrid


def rms_left(
    forwards: Sequence[Forward], recordings: Sequence[Recording], rate: float
) -> tuple[dict[str, tuple[float, ...]], dict[str, str]]:
    """Channel -> rms error [its unit] by each forward, and its unit; NaN where one diverges.

    Args:
        forwards: of one machine, the first as its file has it: its channels that all recordings
            have are told, at the rows of the analysis.
        recordings: one at least.
        rate: of the analysis [Hz].
    """
    recorded = set.intersection(*(set(one.signals) for one in recordings))
    channels = [c for c in forwards[0].channels if c.signal in recorded]
    left = np.array([_left(forward, recordings, channels, rate) for forward in forwards])
    errors = {c.name: tuple(rms) for c, rms in zip(channels, left.T.tolist(), strict=True)}
    return errors, {c.name: c.unit for c in channels}


def _left(
    forward: Forward, recordings: Sequence[Recording], channels: Sequence[Channel], rate: float
) -> FloatArray:
    off, names = [], [channel.name for channel in forward.channels]
    at = [names.index(channel.name) for channel in channels]
    for one in recordings:
        fed = Excitation.of(one, forward.drive, rate=rate)
        measured = np.stack([one[c.signal][:, c.column] for c in channels], axis=1)
        rest = measured - forward.simulate(fed, {})[:, at]
        off.append(AnalysisGrid.of(fed.period, rate).reduce(rest))
    return np.asarray(np.sqrt(np.mean(np.square(np.concatenate(off), dtype=float), axis=0)))
