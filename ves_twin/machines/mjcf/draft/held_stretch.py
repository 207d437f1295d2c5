"""held_stretch, too_short: how long stretches should be that are fitted and held out in turn."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.recording import Recording
from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.record.preprocess import check_lengths
from ves_twin.machines.mjcf.draft.drafting import ROWS, Version
from ves_twin.machines.mjcf.draft.log_columns import LogColumns
from ves_twin.machines.mjcf.draft.predicted import FEWEST
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.motion.pieces import pieces
from ves_twin.machines.mjcf.recordings.interleaved_split import alternate, enough
from ves_twin.machines.mjcf.rig.machine import Rig

STRETCH = 2.0
"""Usual length of a stretch that is held out [s]."""

STRETCHES = 4
"""Stretches that a short log is cut into at least, where each has rows enough: of two alone one is
the slow half of a chirp, or what comes before an arm takes its load."""

OTHERS = (0.8, 1.25, 0.6, 1.6)
"""Factors of a length that are tried where its halves turn different ways."""

BOTH_WAYS = 0.1
"""Share of a joint's way from which the log is said to turn that way, too."""

STEPS = 20
"""Steps of a stretch in which a joint's way is counted: row by row noise goes both ways."""

EVEN = 0.2
"""Share of a joint's way in one direction, over what an even split has, that either half must have.
A worm gear went forth and back once in 20 s: stretches of 5 s (0.04) fitted one way and held out
the other, and viscous friction was proved, ten times too large, in place of dry friction. Stretches
of TX40 that serve have 0.36."""


def held_stretch(now: Version, log: LogColumns) -> float:
    """Length of stretches to hold out [s]; a last one of half a length is one, too.

    Shorter than usual where few would be had, and the shortest that is enough where the usual one
    is not. Where in either half a joint would go less than EVEN of its way in one direction others
    are tried: the first that is even enough is taken, else the most even one. 0 where none is long
    enough, or the log is in pieces already.
    """
    length = max(STRETCH, float(np.ceil(ROWS / now.mode.rate)))
    if now.mode.horizon:
        return 0.0
    part, whole = now.part, log.period * (log.rows - 1)
    if float(np.ptp(part.time)) <= 1.5 * length < whole:  # a part alone was simulated
        return length
    if len(part.time) < FEWEST:
        return 0.0
    shortest = enough(part, now.mode.rate)
    few = max(shortest, _digits(float(np.ptp(part.time)) / STRETCHES))
    best, most = 0.0, 0.0
    for one in _lengths(min(length, few), length, shortest):
        even = _evenness(now.rig, part, one)
        if even > most:
            best, most = one, even
        if most >= EVEN:
            break
    return best


def _lengths(*usual: float) -> Iterator[float]:
    """The usual ones first, none below the last."""
    others = (_digits(factor * one) for one in usual for factor in OTHERS)
    yield from dict.fromkeys([*usual, *(one for one in others if one >= usual[-1])])


def _digits(length: float) -> float:
    return float(f"{length:.2g}")


def _evenness(rig: Rig, part: Recording, length: float) -> float:
    """Least share of any joint's way in one direction that a half has, 1 where both have half.

    A small number where a half has none of it, 0 where a stretch is too short for a diagnosis.
    """
    try:
        halves = alternate(part, length, rig.description.rate)
    except InvalidInputError:
        return 0.0
    if any(too_short(rig, one) for half in halves for one in half):
        return 0.0
    ways = np.array([_ways(rig, half) for half in halves])  # (half, joints, direction)
    whole = ways.sum(axis=0)
    told = whole >= BOTH_WAYS * np.maximum(whole.sum(axis=1, keepdims=True), 1e-30)
    shares = 2.0 * ways.min(axis=0)[told] / np.maximum(whole[told], 1e-30)
    return float(np.clip(np.min(shares, initial=1.0), 1e-3, 1.0))


def _ways(rig: Rig, half: Sequence[Recording]) -> FloatArray:
    """How far each joint went up and down (joints, 2)."""
    found = []
    for signal, is_speed in _moving(rig).items():
        rows = [one[signal][:, 0] for one in half if signal in one.signals]
        steps = rows if is_speed else [np.diff(one[:: max(len(one) // STEPS, 1)]) for one in rows]
        every = np.concatenate([*steps, np.zeros(1)])
        found.append([np.sum(np.maximum(every, 0.0)), np.sum(np.maximum(-every, 0.0))])
    return np.reshape(np.nan_to_num(np.array(found, float)), (-1, 2))


def _moving(rig: Rig) -> dict[str, bool]:
    """Signals of one column that tell a joint's motion; whether they tell its speed."""
    told = rig.description
    found = {signal: False for signal in told.drive.joints.values()}
    found |= {n: c.of == "speed" for n, c in told.compare.items() if c.joint}
    return {n: speed for n, speed in found.items() if len(told.signals[n].columns) == 1}


def too_short(rig: Rig, part: Recording) -> list[str]:
    """That a log, or a piece of it, is too short for a diagnosis, if it is."""
    if len(part.time) < FEWEST:  # a clock in another unit, which is told
        return []
    parts = pieces(rig, part)
    try:
        check_lengths(MjcfForward.of(rig), parts, rig.description.rate)
    except InvalidInputError as short:
        return [f"too short for a diagnosis: {short}"]
    return []
