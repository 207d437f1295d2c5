"""halves_at: the fitted and the held-out half about a point, with every trial's columns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ves_twin.core.types import FloatArray, SingleArray
from ves_twin.diagnosis.bank.linearise import Linearisation, linearise
from ves_twin.diagnosis.build_up.regression import Half, Regression
from ves_twin.diagnosis.build_up.trial_columns import TrialColumns
from ves_twin.diagnosis.build_up.trials import Library, Trial, trials_at
from ves_twin.diagnosis.model.forward import Hypothesis
from ves_twin.diagnosis.record.preprocess import Dataset
from ves_twin.diagnosis.record.runs import Progress, Runs, silent

STRETCHES = 10
"""Stretches that a record is cut into where nothing else is held out, every second one for proof:
five of each is the least that a test over stretches can use."""


@dataclass(frozen=True)
class Halves:
    """A fitted half as a regression, and the held-out half beside it.

    Attributes:
        regression: of the fitted half.
        held: the held-out half.
        measured: rows of the held-out half (rows, c).
    """

    regression: Regression
    held: Half
    measured: SingleArray

    @property
    def sound(self) -> bool:
        """Whether the simulation breaks off nowhere: neither there nor where a nuisance moves."""
        return all(
            bool(np.all(np.isfinite(rows), where=half.kept))
            for half in (self.regression.half, self.held)
            for rows in (half.target, half.shared, half.own)
        )


def halves_at(
    fitted: Dataset,
    held: Dataset,
    point: FloatArray,
    library: Library | Sequence[Hypothesis],
    present: Sequence[Trial] = (),
    progress: Progress = silent,
) -> Halves:
    """Both halves, linear about a point.

    Args:
        fitted: recordings that sizes come from.
        held: recordings that they are judged on.
        point: departures in the fitted recordings (coordinates,).
        library: the causes, with what an earlier look told of them.
        present: trials that are at work at the point.
        progress: told how far it is.
    """
    runs = fitted.runs
    trials, columns = trials_at(runs, point, library, present, progress)
    there = carried_point(runs, held.runs, point)
    same = held.runs.programmes is runs.programmes
    known = dict(enumerate(columns))
    about = linearise(runs, point)
    mine = _half(fitted, about, trials, known, present, same, progress)
    about = about if same else linearise(held.runs, there)
    yours = _half(held, about, trials, known if same else {}, present, same, progress)
    return Halves(Regression(mine, trials), yours, held.measured)


def split(seen: Dataset) -> tuple[Dataset, Dataset]:
    """Every second stretch of a record to fit, the others held out: rows of the other are holes."""
    parts: tuple[list[np.ndarray], list[np.ndarray]] = ([], [])
    for k, rows in enumerate(seen.runs.slices):
        count = rows.stop - rows.start
        first = (np.arange(count) * STRETCHES // count) % 2 == 0
        old = seen.runs.holes[k] if seen.runs.holes else np.zeros((count, 1), bool)
        for part, used in zip(parts, (first, ~first), strict=True):
            part.append(old | ~np.repeat(used[:, None], seen.measured.shape[1], axis=1))
    return (
        replace(seen, runs=replace(seen.runs, holes=tuple(parts[0]))),
        replace(seen, runs=replace(seen.runs, holes=tuple(parts[1]))),
    )


def carried_point(runs: Runs, other: Runs, point: FloatArray) -> FloatArray:
    """A point in other recordings, or of another forward: what is drawn anew there is nominal."""
    same = other.programmes is runs.programmes
    if same and len(other.coordinates) == len(runs.coordinates):
        return point
    shared = {
        (axis.parameter.name, axis.recording): point[i]
        for i, axis in enumerate(runs.coordinates)
        if same or axis.recording == -1
    }
    keys = [(axis.parameter.name, axis.recording) for axis in other.coordinates]
    return np.array([shared.get(key, 0.0) for key in keys])


def _half(
    seen: Dataset,
    local: Linearisation,
    trials: Sequence[Trial],
    known: dict[int, SingleArray],
    present: Sequence[Trial],
    same: bool,
    progress: Progress,
) -> Half:
    """What is to be explained: measured less predicted, with what is at work put back."""
    runs, point = seen.runs, local.point
    target = np.asarray(seen.measured - local.prediction, float)
    columns = TrialColumns(runs, point, trials, local.prediction, progress, known)
    at_work = [n for n, trial in enumerate(trials) if trial in present]
    moved = np.zeros(len(runs.coordinates), bool)
    for n, column in zip(at_work, columns.of(at_work), strict=True):
        target = target + column.sum(axis=0)
        moved[runs.indices(trials[n].cause)] = True
    pull = np.where(moved[runs.nuisances], 0.0, point[runs.nuisances] / runs.sd[runs.nuisances])
    target = np.asarray(target + np.tensordot(pull, local.columns[:-1], axes=1), float)
    return _sorted(seen, local, target, columns, same)


def _sorted(
    seen: Dataset,
    local: Linearisation,
    target: FloatArray,
    columns: TrialColumns,
    same: bool,
) -> Half:
    """Nuisances that both halves share first, then those of single recordings."""
    runs = seen.runs
    own = np.array([runs.coordinates[int(i)].recording != -1 for i in runs.nuisances], bool)
    own = own & (not same)
    shared = np.concatenate([local.columns[:-1][~own], local.columns[-1:]])
    return Half(runs, target, shared, local.columns[:-1][own], columns)
