"""loud_screen: laws of efforts by inverse dynamics, where a record is too loud to be linear."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ves_twin.core.types import FloatArray, SingleArray
from ves_twin.diagnosis.law.candidate import Candidate, Table
from ves_twin.diagnosis.law.fit_law import LawFit
from ves_twin.diagnosis.law.screen import smooth_candidates
from ves_twin.diagnosis.law.smoothness import Smoothness, best_of, projected
from ves_twin.diagnosis.model.law_forward import LawPlace
from ves_twin.diagnosis.record.by_motion import along_motion, by_motion, missing_at, motions
from ves_twin.diagnosis.record.evidence import Evidence
from ves_twin.diagnosis.record.preprocess import Dataset
from ves_twin.effects.law import LawKind, joints_of, variable_along

LOUD = 1e4
"""Chi^2 a sample from which a simulation without the law is far from the motion that was measured:
at 10^6 the linear screen took time for speed in trials, below 10^3 it was right in 30 of 30."""

QUIET = 0.01
"""Effort that counts as noise, as a share of what a law is expected to have."""


@dataclass(frozen=True)
class LoudSuspect:
    """A table as inverse dynamics gives it.

    Attributes:
        candidate: the family.
        numbers: of the law (k,).
        gain: log evidence over no law [nats].
    """

    candidate: Candidate
    numbers: FloatArray
    gain: float


def loud_screen(evidence: Evidence, none: LawFit, places: Sequence[LawPlace]) -> list[LoudSuspect]:
    """Tables of every variable at every joint, by falling evidence.

    What the measured motion asks for beyond the model is regressed on each, commissioning errors
    marginalised by differences of the same inverse dynamics.

    Args:
        evidence: what was measured; its runs are of a `LawForward`.
        none: commissioning errors alone.
        places: where laws may act.

    Returns:
        Nothing where the record is not loud, or its motion is not measured.
    """
    if none.temper < LOUD:
        return []
    told = by_motion(Dataset(evidence.runs, evidence.measured, ()))
    joints = [p for p in places if p.kind is LawKind.EFFORT and _single(p)]
    if told is None or not {missing_at(p.name) for p in joints} <= {*_names(told)}:
        return []
    paths = motions(told, told.runs.origin)
    every = {name: np.concatenate([path[name] for path in paths]) for name in paths[0]}
    ends = {name: (float(np.min(x)), float(np.max(x))) for name, x in every.items()}
    shown = _Shown.of(told, {missing_at(p.name): QUIET * p.scale for p in joints})
    found = [
        shown.suspect(one) for one in smooth_candidates(joints, ends) if isinstance(one, Table)
    ]
    return sorted(found, key=lambda one: -one.gain)


def _names(told: Dataset) -> list[str]:
    return [channel.name for channel in told.runs.forward.channels]


def _single(place: LawPlace) -> bool:
    return len(joints_of(place.name)) == 1


@dataclass(frozen=True)
class _Shown:
    """Efforts that are missing, in units of their noise.

    Attributes:
        told: recordings by their motion.
        scale: channel -> sd of its noise.
        efforts: (samples,).
        errors: what one sd of each commissioning error takes away (samples, k).
    """

    told: Dataset
    scale: Mapping[str, float]
    efforts: FloatArray
    errors: FloatArray

    @staticmethod
    def of(told: Dataset, scale: Mapping[str, float]) -> _Shown:
        runs, empty = told.runs, np.zeros(0)
        first = _Shown(told, scale, empty, empty)
        base, origin = runs.one(runs.origin), runs.origin
        moved = [runs.depart(origin, np.array([i]), runs.sd[i]) for i in runs.nuisances]
        errors = [first.flat(runs.one(there) - base) for there in moved]
        return _Shown(told, scale, first.flat(-base), np.stack(errors, axis=1))

    def flat(self, rows: FloatArray | SingleArray) -> FloatArray:
        """Samples of rows (rows, channels) that count, in units of noise."""
        names = _names(self.told)
        at, sd = [names.index(name) for name in self.scale], np.array([*self.scale.values()])
        return np.asarray((rows[:, at] / sd)[self.told.runs.kept[:, at]], float)

    def suspect(self, table: Table) -> LoudSuspect:
        """One table."""
        own = _names(self.told).index(missing_at(table.place.name))
        width = len(_names(self.told))

        def hats(path: Mapping[str, FloatArray]) -> FloatArray:
            x = variable_along(table.of[0].name, path)
            return np.stack([np.interp(x, table.knots, row) for row in np.eye(len(table.knots))]).T

        rows = along_motion(self.told, self.told.runs.origin, hats)
        columns = np.zeros((rows.shape[1], len(rows), width))
        columns[:, :, own] = rows.T
        flat = np.stack([self.flat(column) for column in columns], axis=1)
        temper = max(1.0, float(np.mean(np.square(self.efforts))))
        gram, slope = projected(flat, self.errors, self.efforts, temper)
        smooth = best_of(gram, slope, table)
        return LoudSuspect(table, _mean(gram, slope, smooth, table), smooth.gain)


def _mean(gram: FloatArray, slope: FloatArray, smooth: Smoothness, table: Table) -> FloatArray:
    prior = np.linalg.inv(smooth.size**2 * table.kernels[smooth.length])
    return np.asarray(np.linalg.solve(gram + prior, slope))
