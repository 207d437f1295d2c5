"""observe: recordings as rows on the analysis grid, beside the runs that predict them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ves_twin.diagnosis.forward import Channel, Forward, Programme, check_forward
from ves_twin.diagnosis.runs import Runs
from ves_twin.errors import InvalidInputError, UnknownNameError
from ves_twin.recording.recording import Recording
from ves_twin.types import FloatArray, SingleArray
from ves_twin.workers import Workers

FEWEST_ROWS = 100
"""Rows of the grid below which bands and stretches of time mean nothing."""


@dataclass(frozen=True)
class Observed:
    """What was measured and the runs that predict it.

    Attributes:
        runs: predictions of all recordings.
        measured: channels on the grid (rows, c).
        unseen: channels of the plant that are not in every recording.
    """

    runs: Runs
    measured: SingleArray
    unseen: tuple[str, ...]


def observe(
    forward: Forward, recordings: Sequence[Recording], workers: Workers | None = None
) -> Observed:
    """Put recordings on the analysis grid.

    Args:
        forward: whose channels are compared and whose drive is fed in.
        recordings: one or more.
        workers: for predictions; this process if None.

    Raises:
        UnknownNameError: a drive signal that is not recorded, or no channel of the plant at all.
        InvalidInputError: no recording, gaps, values that are not finite, or too short a one.
    """
    check_forward(forward)
    if not recordings:
        raise InvalidInputError("recordings", "none", "at least one")
    columns = tuple(
        c
        for c, channel in enumerate(forward.channels)
        if all(_holds(recording, channel) for recording in recordings)
    )
    if not columns:
        wanted = forward.channels[0].signal
        raise UnknownNameError("signal in the recordings", wanted, recordings[0].signals)
    channels = [forward.channels[c] for c in columns]
    programmes, rows = [], []
    for k, recording in enumerate(recordings):
        name = recording.info.scenario or f"recording {k + 1}"
        programmes.append(Programme.of(recording, forward.drive, name))
        rows.append(_rows(recording, channels, forward.drive, name))
    runs = Runs(forward, tuple(programmes), columns, workers or Workers())
    for programme, time in zip(programmes, runs.times, strict=True):
        if len(time) < FEWEST_ROWS:
            raise InvalidInputError(
                f"rows of {programme.name} on the grid", len(time), f"at least {FEWEST_ROWS}"
            )
    stacks = [grid.reduce(piece) for grid, piece in zip(runs.grids, rows, strict=True)]
    unseen = [channel.name for c, channel in enumerate(forward.channels) if c not in columns]
    return Observed(runs, np.concatenate(stacks), tuple(unseen))


def _holds(recording: Recording, channel: Channel) -> bool:
    values = recording.signals.get(channel.signal)
    return values is not None and values.shape[1] > channel.column


def _rows(
    recording: Recording, channels: Sequence[Channel], drive: Sequence[str], name: str
) -> FloatArray:
    for signal in {*drive, *(channel.signal for channel in channels)}:
        bad = np.count_nonzero(~np.isfinite(recording[signal]).all(axis=1))
        if bad:
            raise InvalidInputError(f"{signal} of {name}", f"{bad} rows without a value", "numbers")
    return np.stack([recording[c.signal][:, c.column] for c in channels], axis=1)
