"""loud_screen: laws of efforts by inverse dynamics, where a record is too loud to be linear."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.evidence import Evidence
from ves_twin.diagnosis.law.candidate import Candidate, Table
from ves_twin.diagnosis.law.fit_law import LawFit
from ves_twin.diagnosis.law.missing import missing_along, smooth_channels
from ves_twin.diagnosis.law.place import LawForward, LawPlace
from ves_twin.diagnosis.law.screen import smooth_candidates
from ves_twin.diagnosis.law.smoothness import Smoothness, best_of, projected
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
    plant = evidence.runs.forward
    if none.temper < LOUD or not isinstance(plant, LawForward):
        return []
    joints = {p.name: p for p in places if p.kind is LawKind.EFFORT and _single(p)}
    shown = _Shown.of(evidence, plant, joints)
    if shown is None:
        return []
    ends = {name: (float(np.min(x)), float(np.max(x))) for name, x in shown.path.items()}
    of_efforts = [one for one in smooth_candidates([*joints.values()], ends)]
    found = [shown.suspect(one) for one in of_efforts if isinstance(one, Table)]
    return sorted(found, key=lambda one: -one.gain)


def _single(place: LawPlace) -> bool:
    return len(joints_of(place.name)) == 1


@dataclass(frozen=True)
class _Shown:
    """Efforts that are missing, of all joints one after the other.

    Attributes:
        joints: places, in that order.
        efforts: over QUIET of each joint's expected size (joints * n,).
        errors: change for one commissioning sd (joints * n, k).
        path: variables (n,).
    """

    joints: Mapping[str, LawPlace]
    efforts: FloatArray
    errors: FloatArray
    path: Mapping[str, FloatArray]

    @staticmethod
    def of(evidence: Evidence, plant: LawForward, joints: Mapping[str, LawPlace]) -> _Shown | None:
        runs = evidence.runs
        motion = smooth_channels(runs, np.asarray(evidence.measured, float))
        base = missing_along(runs, plant, motion, runs.origin)
        if base is None or not joints.keys() <= base[0].keys():
            return None
        scale = {name: QUIET * place.scale for name, place in joints.items()}

        def stacked(efforts: Mapping[str, FloatArray]) -> FloatArray:
            return np.concatenate([efforts[name] / scale[name] for name in joints])

        here, columns = stacked(base[0]), []
        for i in runs.nuisances:
            shift = runs.depart(runs.origin, np.array([i]), runs.sd[i])
            moved = missing_along(runs, plant, motion, shift)
            if moved is not None:
                columns.append(stacked(moved[0]) - here)
        return _Shown(joints, here, np.stack(columns, axis=1), base[1])

    def suspect(self, table: Table) -> LoudSuspect:
        """One table."""
        x = variable_along(table.of[0].name, self.path)
        hats = np.stack([np.interp(x, table.knots, row) for row in np.eye(len(table.knots))])
        columns = np.zeros((len(self.joints), len(x), len(hats)))
        own = [*self.joints].index(table.place.name)
        columns[own] = hats.T / (QUIET * table.place.scale)
        flat = columns.reshape(-1, len(hats))
        temper = max(1.0, float(np.mean(np.square(self.efforts))))
        # a commissioning error takes away what it adds
        gram, slope = projected(flat, -self.errors, self.efforts, temper)
        smooth = best_of(gram, slope, table)
        return LoudSuspect(table, _mean(gram, slope, smooth, table), smooth.gain)


def _mean(gram: FloatArray, slope: FloatArray, smooth: Smoothness, table: Table) -> FloatArray:
    prior = np.linalg.inv(smooth.size**2 * table.kernels[smooth.length])
    return np.asarray(np.linalg.solve(gram + prior, slope))
