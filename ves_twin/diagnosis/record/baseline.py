"""usual_rows: what a rig in order shows along the programmes of a record, aligned in time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.quantity import percent
from ves_twin.core.recording.recording import Recording
from ves_twin.core.types import FloatArray, SingleArray
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.diagnosis.record.preprocess import Dataset, preprocess
from ves_twin.diagnosis.record.repeated import REPEATS, apart, lag_of
from ves_twin.diagnosis.record.runs import Runs

SAME = 1e-3
"""Difference of two set-points, of their range, up to which programmes count as the same."""

EVEN = 0.01
"""Share of a row's period by which two clocks may differ."""


@dataclass(frozen=True)
class Usual:
    """What a rig in order shows.

    Attributes:
        rows: mean over the recordings of each programme (rows, c).
        count: the fewest recordings of one programme.
        differs: largest difference of their inputs from the record's, of the input's range.
    """

    rows: SingleArray
    count: int
    differs: float


def usual_rows(seen: Dataset, baseline: Sequence[Recording]) -> Usual:
    """Recordings of a rig in order beside those that are diagnosed.

    A programme that was given again is taken as it is. A measured motion repeats less exactly: the
    recording is moved in time to where its inputs are nearest, all of the record's rows must be in
    it, and what the nominal model says the remaining difference of inputs does is taken off:

        y = y_b + f(u) - f(u_b).

    Args:
        seen: the record that is diagnosed.
        baseline: recordings of the same rig in order, one or more for each programme.

    Raises:
        InvalidInputError: a programme without a baseline; says the nearest one.
    """
    runs = seen.runs
    pieces, fewest, differs = [], len(baseline), 0.0
    for k, programme in enumerate(runs.programmes):
        found = [_along(recording, programme, runs) for recording in baseline]
        fits = [one for one in found if one.rows is not None]
        rows = [one.rows for one in found if one.rows is not None]
        if not rows:
            nearest = min(found, key=lambda one: one.differs)
            raise InvalidInputError(
                f"baseline of recording {k + 1} ({programme.name})",
                nearest.why,
                f"the same inputs to {percent(REPEATS)} of their range, made while the rig was in"
                " order, over all of the recording",
            )
        pieces.append(np.mean(rows, axis=0, dtype=np.float32))
        fewest = min(fewest, len(rows))
        differs = max(differs, *(one.differs for one in fits))
    return Usual(np.concatenate(pieces), fewest, differs)


@dataclass(frozen=True)
class _Along:
    """A baseline along one programme; no rows where it is another motion, and why."""

    rows: SingleArray | None
    differs: float
    why: str = ""


def _along(recording: Recording, programme: Excitation, runs: Runs) -> _Along:
    drive = {name: recording.signals.get(name) for name in programme.drive}
    missing = [name for name, values in drive.items() if values is None]
    if missing:
        return _Along(None, np.inf, f"none with {missing[0]}")
    given = {name: values for name, values in drive.items() if values is not None}
    count = len(programme.time)
    lag = lag_of(given, programme.drive) if not _alike(given, programme.drive) else 0
    if lag is None:
        have = len(recording.time)
        return _Along(
            None, np.inf, f"one with {have} rows for {count}; cut the record with a window"
        )
    rows = slice(lag, lag + count)
    period = float(recording.time[-1] - recording.time[0]) / (len(recording.time) - 1)
    if not programme.poses and abs(period - programme.period) > EVEN * programme.period:
        return _Along(None, np.inf, f"one with rows {period:.4g} s apart")
    differs = max(apart(given[name][rows], values) for name, values in programme.drive.items())
    if differs > REPEATS:
        return _Along(None, differs, f"inputs that differ by {percent(differs)} of their range")
    signals = {name: values[rows] for name, values in recording.signals.items()}
    there = preprocess(
        runs.forward,
        [Recording(programme.time, signals, recording.info)],
        runs.workers,
        programme.rate,
    )
    if there.runs.columns != runs.columns:
        return _Along(None, np.inf, "one with other signals")
    if differs <= SAME:
        return _Along(there.measured, differs)
    here = Runs(runs.forward, (programme,), runs.columns, runs.workers)
    change = here.one(here.origin) - there.runs.one(there.runs.origin)
    return _Along(np.asarray(there.measured + change, np.float32), differs)


def _alike(one: Mapping[str, FloatArray], two: Mapping[str, FloatArray]) -> bool:
    """Whether two programmes feed in the same."""
    return all(
        one[name].shape == two[name].shape and apart(one[name], two[name]) <= SAME for name in two
    )
