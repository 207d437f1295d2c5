"""separations: which next programme would tell the rivals apart."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ves_twin.core.types import FloatArray, IntArray
from ves_twin.diagnosis.bank.linearise import linearise
from ves_twin.diagnosis.bank.metric import Metric
from ves_twin.diagnosis.experiment.separation import parted
from ves_twin.diagnosis.fit.refine import Fit
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.diagnosis.record.runs import Runs
from ves_twin.diagnosis.record.whitening import whitening_declared

NUISANCES = 16
"""Commissioning parameters of the plant that are marginalised where there are more: those that go
along most with what parts the rivals. Each costs two runs of every programme."""


@dataclass(frozen=True)
class Separation:
    """A programme and the chi^2 by which it is expected to part the two likest rivals."""

    programme: Excitation
    chi2: float


def separations(
    there: Runs, rivals: Sequence[Fit], programmes: Sequence[Excitation]
) -> list[Separation]:
    """Candidate programmes by falling separation of the rivals.

    For rivals i and j the separation is min over a of |s_i - a s_j|^2 + (a - 1)^2 D_j^2 with the
    nuisances marginalised: what rival j leaves unexplained of rival i. D_j is its size over its sd
    in the recordings that are there, which hold it: a programme that a cause leaves as it is parts
    it from a rival that would show there.

    Args:
        there: runs in which the rivals were fitted.
        rivals: their fits.
        programmes: what could be fed in next.
    """
    found = []
    axes = _axes(there, rivals) if programmes else None
    held = np.array([fit.power for fit in rivals])
    for programme in programmes:
        runs = Runs(there.forward, (programme,), there.columns, there.workers)
        base = linearise(runs, runs.origin, axes=_on(runs, there, axes))
        whitening = whitening_declared(runs)
        metric = Metric(whitening.apply(base.columns).T)
        shifts = [_carry(there, fit, runs) for fit in rivals]
        changes = whitening.apply(runs.many(shifts) - base.prediction).T
        gram = changes.T @ metric.project(changes)
        found.append(Separation(programme, float(np.min(parted(gram, held)))))
    return sorted(found, key=lambda separation: -separation.chi2)


def _axes(there: Runs, rivals: Sequence[Fit]) -> IntArray | None:
    """Coordinates of the plant that could stand for the difference of the rivals; None for all.

    In the recordings that are there, the difference of two rivals' traces is small because
    commissioning errors make up for it; those with the largest share in that count.
    """
    own = np.array([i for i in there.nuisances if there.coordinates[i].recording == -1], int)
    if len(own) <= NUISANCES or len(rivals) < 2:
        return None
    pulls = [fit.shift[own] / there.sd[own] for fit in rivals[:2]]
    local = rivals[0].local
    whitening = whitening_declared(there)
    rows = np.searchsorted(there.nuisances, own)
    columns = whitening.apply(local.columns[rows])
    share = np.abs(pulls[0] - pulls[1]) * np.linalg.norm(columns, axis=1)
    return np.sort(own[np.argsort(-share)[:NUISANCES]])


def _on(runs: Runs, there: Runs, axes: IntArray | None) -> tuple[IntArray, FloatArray] | None:
    """The same coordinates in other runs, and what is drawn anew in each recording."""
    if axes is None:
        return None
    names = [axis.parameter.name for axis in runs.coordinates]
    shared = [names.index(there.coordinates[i].parameter.name) for i in axes]
    new = [int(i) for i in runs.nuisances if runs.coordinates[i].recording != -1]
    where = np.array(sorted([*shared, *new]), int)
    return where, runs.sd[where]


def _carry(there: Runs, fit: Fit, runs: Runs) -> FloatArray:
    """A cause's departures alone, on the axes of other runs."""
    names = [axis.parameter.name for axis in runs.coordinates]
    free = fit.active[: len(fit.sizes)]
    where = np.array([names.index(there.coordinates[i].parameter.name) for i in free], int)
    return runs.depart(runs.origin, where, fit.sizes)
