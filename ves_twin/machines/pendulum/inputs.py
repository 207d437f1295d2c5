"""prepare_pendulum: recordings of a pendulum and where each began, as its first rows tell."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ves_twin.core.recording.recording import Recording
from ves_twin.core.types import FloatArray
from ves_twin.machines.pendulum.forward import CHANNELS, START, Pendulum

FIRST = 0.05
"""Time whose rows tell the start [s]."""

FEWEST = 5
"""Rows that tell it at least."""

REST = (0.1, 0.05)
"""Angle [rad] and rate [rad/s] up to which a recording is taken to begin at rest: what the start of
one may be off, and ten commissioning sd; an encoder's bias moves the angle alone."""


@dataclass(frozen=True)
class PendulumInputs:
    """The plant as these recordings need it.

    Attributes:
        plant: at rest at the start if every recording is.
        groups: the recordings, with their start where the plant asks for it.
    """

    plant: Pendulum
    groups: tuple[tuple[Recording, ...], ...]


def prepare_pendulum(plant: Pendulum, *groups: Sequence[Recording]) -> PendulumInputs:
    """Tell the plant where recordings begin that do not begin at rest.

    A recording may say it itself (`joint.start`). Where it does not, and its first rows move or
    hang far from nominal, it was cut out of a longer motion: its start is read off those rows and
    known to no more than `UNKNOWN_START`, and what delays held back from before is left out.

    Args:
        plant: as it is for recordings that begin at rest.
        *groups: recordings: measured, held out, and so on.
    """
    begins = [[_begin(recording) for recording in group] for group in groups]
    every = [begin for group in begins for begin in group]
    if not any(begin.moves for begin in every):
        return PendulumInputs(plant, tuple(tuple(group) for group in groups))
    known = not any(begin.read for begin in every)
    return PendulumInputs(
        plant.anywhere(known),
        tuple(
            tuple(_with_start(r, begin) for r, begin in zip(group, found, strict=True))
            for group, found in zip(groups, begins, strict=True)
        ),
    )


@dataclass(frozen=True)
class _Begin:
    """Angle and rate at the start, whether it is another one than rest, whether it was read."""

    state: FloatArray
    moves: bool
    read: bool


def _begin(recording: Recording) -> _Begin:
    if START.name in recording.signals:
        return _Begin(recording[START.name][0], True, False)
    state = _first_state(recording)
    moves = bool(np.any(np.abs(state) > REST))
    return _Begin(state if moves else np.zeros(2), moves, moves)


def _first_state(recording: Recording) -> FloatArray:
    """Angle and rate at the first row, of a parabola through the first ones; 0 if not recorded."""
    if any(channel.signal not in recording.signals for channel in CHANNELS):
        return np.zeros(2)
    time = recording.time - recording.time[0]
    count = max(FEWEST, int(np.searchsorted(time, FIRST)))
    time = time[:count]
    angle, rate = (recording[c.signal][:count, c.column] for c in CHANNELS)
    one, none = np.ones(len(time)), np.zeros(len(time))
    about_angle = np.stack([one, time, time**2 / 2.0], axis=1) / CHANNELS[0].sd
    about_rate = np.stack([none, one, time], axis=1) / CHANNELS[1].sd
    rows = np.concatenate([about_angle, about_rate])
    read = np.concatenate([angle / CHANNELS[0].sd, rate / CHANNELS[1].sd])
    kept = np.isfinite(read)
    if np.count_nonzero(kept) < FEWEST:
        return np.zeros(2)
    return np.asarray(np.linalg.lstsq(rows[kept], read[kept], rcond=None)[0][:2])


def _with_start(recording: Recording, begin: _Begin) -> Recording:
    if START.name in recording.signals:
        return recording
    told = np.tile(begin.state, (len(recording.time), 1))
    info = replace(recording.info, own_signals=(*recording.info.own_signals, START))
    return replace(recording, signals={**recording.signals, START.name: told}, info=info)
