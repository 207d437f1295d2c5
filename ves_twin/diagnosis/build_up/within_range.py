"""within_range: a proof in which what fits only at an end of its range leaves its place."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.build_up.exchanged import exchanged
from ves_twin.diagnosis.build_up.in_full import in_full
from ves_twin.diagnosis.build_up.proof import Proof
from ves_twin.diagnosis.build_up.stand_ins import StandIns
from ves_twin.diagnosis.fit.refine import Fit
from ves_twin.diagnosis.record.evidence import Evidence

NEAR = 0.01
"""Share of its range from an end within which a size is at that end: bounds hold it there."""

MOST = 3
"""Others that are tried in its place: each costs a full fit of all."""


def within_range(
    proof: Proof, fit: Fit, point: FloatArray, evidence: Evidence
) -> tuple[Proof, Fit]:
    """The proof with others in the place of those whose size ends at its range, and its full fit.

    A range says what a machine can have. What needs more stands for something else: the centre of
    mass of an arm's first link, 0.2 m off, for a rotor that nobody declared. Of the causes that
    held-out rows cannot tell from it the first takes its place that is proved as everything is,
    stays within its own range and leaves no more.

    Args:
        proof: what is proved.
        fit: of all of it with the full simulation.
        point: departures where columns were computed (coordinates,).
        evidence: of the fitted half.
    """
    ends = [n for n in proof.proved if _at_end(proof, n, fit, evidence)]
    if not ends or evidence.runs.budget.skips("others in the place of what ends its range"):
        return proof, fit
    others = StandIns.of(proof).within
    for n in ends:
        for other in others[n][:MOST]:
            tried = exchanged(proof, {n: other})
            proof = replace(proof, tested=tried.tested)
            if other not in tried.proved:
                continue
            there = in_full(tried.bench.regression, tried.proved, point, evidence, probed=True)
            if there.chi2 <= fit.chi2 and not _at_end(tried, other, there, evidence):
                proof, fit = tried, there
                break
    return proof, fit


def _at_end(proof: Proof, trial: int, fit: Fit, evidence: Evidence) -> bool:
    """Whether a size of a trial's cause is held by an end of its range."""
    runs = evidence.runs
    where = runs.indices(proof.bench.regression.trials[trial].cause)
    size, low, high = fit.shift[where], runs.low[where], runs.high[where]
    near = NEAR * (high - low)
    return bool(np.any((size <= low + near) & (low < 0.0)) or np.any(size >= high - near))
