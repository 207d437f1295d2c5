"""preprocess: recordings as rows on the analysis grid, beside the runs that predict them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.recording.recording import Recording
from ves_twin.core.types import BoolArray, FloatArray, SingleArray
from ves_twin.core.workers import Workers
from ves_twin.data.clock.usual_period import is_usual
from ves_twin.diagnosis.model.forward import Channel, Excitation, Forward, check_forward
from ves_twin.diagnosis.model.grid import RATE, AnalysisGrid
from ves_twin.diagnosis.record.runs import Runs
from ves_twin.diagnosis.record.whitening import FEWEST, ORDER, whole

MOST_EMPTY = 0.5
"""Share of a channel's rows that must have values; else it counts as not recorded."""

FEWEST_ROWS = 100
"""Rows of the grid below which bands and stretches of time mean nothing."""

MOST_SETTLING = 0.2
"""Share of a recording that may count as settling."""

FEWEST_POSES = 12
"""Poses at rest below which their scatter means nothing."""


@dataclass(frozen=True)
class Dataset:
    """What was measured and the runs that predict it.

    Attributes:
        runs: predictions of all recordings.
        measured: channels on the grid (rows, c).
        unseen: channels of the plant that are not in every recording, or have holes all over.
        holes: share of the rows without a value, of each channel that has some.
    """

    runs: Runs
    measured: SingleArray
    unseen: tuple[str, ...]
    holes: Mapping[str, float] = field(default_factory=dict)


def preprocess(
    forward: Forward,
    recordings: Sequence[Recording],
    workers: Workers | None = None,
    rate: float = RATE,
) -> Dataset:
    """Put recordings on the analysis grid.

    Args:
        forward: whose channels are compared and whose drive is fed in.
        recordings: one or more.
        workers: for predictions; this process if None.
        rate: of the analysis grid [Hz].

    Raises:
        UnknownNameError: a drive signal that is not recorded, or no channel of the plant at all.
        InvalidInputError: no recording, rows that are missing, set-points without a value, too
            short a recording, or holes all over every channel.
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
    programmes, rows = [], []
    for k, recording in enumerate(recordings):
        name = recording.info.scenario or f"recording {k + 1}"
        _check_drive(recording, forward.drive, name)
        programmes.append(Excitation.of(recording, forward.drive, name, rate))
        rows.append(_rows(recording, [forward.channels[c] for c in columns]))
    runs = Runs(forward, tuple(programmes), columns, workers or Workers())
    _check_length(runs)
    empty = [~np.isfinite(piece) for piece in rows]
    lost = np.mean(np.concatenate(empty), axis=0)
    names = [forward.channels[c].name for c in columns]
    holes = {name: float(share) for name, share in zip(names, lost, strict=True) if share > 0.0}
    marked = _marked(runs, empty)
    sound = _sound(runs, marked)
    runs = replace(runs, columns=tuple(np.array(columns)[sound].tolist()))
    if any(bad[:, sound].any() for bad in marked):
        runs = replace(runs, holes=tuple(bad[:, sound] for bad in marked))
    pairs = zip(runs.grids, rows, strict=True)
    stacks = [grid.reduce(_bridged(piece[:, sound])) for grid, piece in pairs]
    unseen = [channel.name for c, channel in enumerate(forward.channels) if c not in runs.columns]
    return Dataset(runs, np.concatenate(stacks), tuple(unseen), holes)


def check_lengths(forward: Forward, recordings: Sequence[Recording], rate: float = RATE) -> None:
    """Refuse recordings that `preprocess` would find too short, before anything is simulated.

    Args:
        forward: the plant.
        recordings: of it; none is fine.
        rate: of the analysis grid [Hz].

    Raises:
        UnknownNameError: a drive signal that is not recorded.
        InvalidInputError: rows that are missing, or too short a recording.
    """
    programmes = []
    for k, recording in enumerate(recordings):
        name = recording.info.scenario or f"recording {k + 1}"
        _check_drive(recording, forward.drive, name)
        programmes.append(Excitation.of(recording, forward.drive, name, rate))
    _check_length(Runs(forward, tuple(programmes), (), Workers()))


def fewest_rows(period: float, rate: float = RATE) -> int:
    """Rows of a recording that `preprocess` does not find too short.

    Args:
        period: between its rows [s].
        rate: of the analysis grid [Hz].
    """
    grid = AnalysisGrid.of(period, rate)
    return (FEWEST_ROWS - 1) * grid.factor + len(grid.taps)


def _rows(recording: Recording, channels: Sequence[Channel]) -> FloatArray:
    return np.stack([recording[c.signal][:, c.column] for c in channels], axis=1)


def _check_length(runs: Runs) -> None:
    """Refuse a recording in which bands and stretches of time mean nothing."""
    for programme, grid, time in zip(runs.programmes, runs.grids, runs.times, strict=True):
        fewest = FEWEST_POSES if programme.poses else FEWEST_ROWS
        if len(time) < fewest:
            what = f"rows of {_part(programme)} at {1.0 / grid.step:.3g} Hz"
            length = float(np.ptp(programme.time)) + (fewest + 1 - len(time)) * grid.step
            span = "" if programme.poses else f", so {length:.2f} s"
            expected = (
                f"at least {fewest}{span}: a longer recording, stretch (--alternate; without it"
                f" every second tenth is held out) or piece (drive.horizon){_finer(programme)}"
            )
            raise InvalidInputError(what, len(time), expected)


def _part(programme: Excitation) -> str:
    """What was too short: a recording, or a stretch or a piece of it."""
    if programme.poses:
        return programme.name
    begin, end = programme.time[[0, -1]]
    return f"{programme.name} from {begin:.2f} to {end:.2f} s"


def _finer(programme: Excitation) -> str:
    """That a higher analysis rate would do, where the recording itself has the rows."""
    rows = len(programme.time)
    if programme.poses or rows < 2:
        return ""
    step = float(np.median(np.diff(programme.time)))
    if not is_usual(step):
        return f", or the clock in its own unit (rows are {step:.3g} s apart)"
    period = float(np.mean(np.diff(programme.time)))
    for factor in range(AnalysisGrid.of(period, programme.rate or RATE).factor - 1, 0, -1):
        rate = 1.0 / (period * factor)
        if fewest_rows(period, rate) <= rows:
            told = f"rate = {float(f'{rate:.3g}'):g}"
            return f", or {told} in the machine's file ({rows} rows were recorded)"
    return ""


def _marked(runs: Runs, empty: Sequence[BoolArray]) -> list[BoolArray]:
    """Rows of the grid (m, c) of each recording that tell nothing: of holes, or too early."""
    channels = [runs.forward.channels[c] for c in runs.columns]
    return [
        grid.touched(bad) | _settling(runs, k, channels)
        for k, (grid, bad) in enumerate(zip(runs.grids, empty, strict=True))
    ]


def _sound(runs: Runs, marked: Sequence[BoolArray]) -> BoolArray:
    """Channels (c,) of which every recording has enough samples that no hole reaches."""
    counts = [
        np.sum(whole(bad, ORDER + 1), axis=0)
        for programme, bad in zip(runs.programmes, marked, strict=True)
        if not programme.poses
    ]
    if not counts:
        return np.ones(len(runs.columns), bool)
    fewest = np.min(counts, axis=0)
    if np.all(fewest < FEWEST):
        raise InvalidInputError(
            "samples between the holes of the recordings",
            int(np.max(fewest)),
            f"at least {FEWEST} of one channel: a missing row takes the rows about it with it",
        )
    return np.asarray(fewest >= FEWEST)


def _settling(runs: Runs, recording: int, channels: Sequence[Channel]) -> BoolArray:
    """Rows of the grid (m, c) that anything too early to tell goes into."""
    programme, time = runs.programmes[recording], runs.programmes[recording].time
    since = np.full(len(time), np.inf) if programme.poses else time - time[0]
    first = np.minimum([c.settling for c in channels], MOST_SETTLING * (time[-1] - time[0]))
    return runs.grids[recording].touched(since[:, None] < first)


def _holds(recording: Recording, channel: Channel) -> bool:
    """Whether a recording has a channel, with values in most of its rows."""
    values = recording.signals.get(channel.signal)
    if values is None or values.shape[1] <= channel.column:
        return False
    return bool(np.mean(np.isfinite(values[:, channel.column])) > MOST_EMPTY)


def _check_drive(recording: Recording, drive: Sequence[str], name: str) -> None:
    """Without a set-point nobody knows what was predicted from."""
    for signal in drive:
        bad = np.count_nonzero(~np.isfinite(recording[signal]).all(axis=1))
        if bad:
            raise InvalidInputError(
                f"{signal} of {name}", f"{bad} rows without a value", "set-points in every row"
            )


def _bridged(rows: FloatArray) -> FloatArray:
    """Rows (n, c) with lines across what is missing, which keeps the low-pass finite."""
    at, filled = np.arange(len(rows)), rows.copy()
    for column in filled.T:
        bad = ~np.isfinite(column)
        column[bad] = np.interp(at[bad], at[~bad], column[~bad])
    return filled
