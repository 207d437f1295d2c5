"""tried, settled: suspects fitted with the full forward, roughly, then by the leader's columns."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.bank.linearise import Linearisation, renewed
from ves_twin.diagnosis.bank.screen import Candidate
from ves_twin.diagnosis.fit.assess import Assessment
from ves_twin.diagnosis.fit.fit_context import FitContext
from ves_twin.diagnosis.fit.fit_job import FitJob
from ves_twin.diagnosis.fit.refine import Fit, near, refine
from ves_twin.diagnosis.model.forward import Hypothesis
from ves_twin.diagnosis.record.evidence import Evidence

RIVAL_RATIO = 4.0
"""A fit with this many times the chi^2 of the best is not worth new nuisance columns."""

CLOSE = 40.0
"""chi^2 that four times the odds are worth which settle a name."""


def tried(desk: FitContext, suspects: list[Candidate]) -> list[Fit]:
    """Suspects fitted roughly, each from the sizes that it may have."""
    first = desk.first
    begin = start_of(first)
    jobs, owner = [], []
    for n, suspect in enumerate(suspects):
        hypothesis = first.screen.bank.hypotheses[suspect.hypothesis]
        if first.beside is not None and first.beside.causes == (hypothesis,):
            jobs.append(replace(FitJob.again(first.evidence, first.beside), rough=True))
            owner.append(n)
            continue
        for sizes in _starts(first, suspect):
            jobs.append(job(first.evidence, (hypothesis,), [sizes], begin))
            owner.append(n)
    found = refined(jobs, desk, "fitting single causes")
    return [
        min((f for f, o in zip(found, owner, strict=True) if o == n), key=lambda fit: fit.chi2)
        for n in sorted(set(owner))
    ]


def job(
    evidence: Evidence,
    causes: tuple[Hypothesis, ...],
    sizes: list[FloatArray],
    begin: Start,
) -> FitJob:
    """From a point and the columns there, with the causes at given sizes; roughly, at first."""
    runs, shift = evidence.runs, begin.shift
    for cause, size in zip(causes, sizes, strict=True):
        shift = runs.depart(shift, runs.indices(cause), size)
    return FitJob(evidence, causes, shift, begin.local, begin.step_share, True)


def refined(jobs: list[FitJob], desk: FitContext, what: str) -> list[Fit]:
    """The fits of jobs, by the workers."""
    fits: list[Fit] = []
    for fit in desk.first.evidence.runs.workers.map(FitJob.run, jobs):
        desk.progress(len(fits) / len(jobs), what)
        fits.append(fit)
    return fits


@dataclass(frozen=True)
class Start:
    """Where fits begin: commissioning errors, the columns there, the step's share."""

    shift: FloatArray
    local: Linearisation
    step_share: float = 0.0


def start_of(first: Assessment) -> Start:
    """Commissioning errors as the last look left them, and the newest columns."""
    last = first.commissioning
    if last is None:
        return Start(first.evidence.runs.origin, first.screen.bank.base)
    return Start(last.shift, last.local, last.step_share)


def settled(
    evidence: Evidence, fits: list[Fit], desk: FitContext, leader: Fit | None = None
) -> list[Fit]:
    """Fits by columns computed at the leader: what rivals share of the commissioning errors.

    Hopeless rivals stay as they are. Where a rival leads then, once more at its own.

    Args:
        evidence: what was measured.
        fits: rough ones.
        desk: how many linearisations.
        leader: the one to begin with; the best if None.
    """
    for _ in range(2):
        leader = leader or min(fits, key=lambda fit: fit.chi2)
        first = again(evidence, leader, desk.settings.rounds)
        others = [fit for fit in fits if fit is not leader]
        jobs = [
            FitJob.again(evidence, fit, first.local, within_reach(first, desk))
            for fit in others
            if is_near(fit, first)
        ]
        rivals = refined(jobs, desk, "fitting its rivals")
        fits = [first, *rivals, *(fit for fit in others if not is_near(fit, first))]
        if all(rival.chi2 >= first.chi2 for rival in rivals):
            break
        leader = None
    return fits


def is_near(fit: Fit, leader: Fit) -> bool:
    """Whether a fit is worth new nuisance columns."""
    return fit.chi2 < RIVAL_RATIO * leader.chi2


def within_reach(leader: Fit, desk: FitContext) -> float:
    """chi^2 beyond which a rival of a leader is clearly worse, whatever else is weighed."""
    return leader.chi2 + CLOSE + desk.settings.model_error**2 * leader.power


def again(evidence: Evidence, fit: Fit, rounds: int) -> Fit:
    """From where a fit ended, with columns computed there before anything is searched."""
    local = fit.local
    if rounds and not near(local, fit.shift):
        local, rounds = renewed(local, fit.shift, fit.prediction), rounds - 1
    at = (fit.shift, local, rounds, fit.step_share)
    return refine(evidence, fit.causes, *at, known=fit.columns)


def crossed(evidence: Evidence, fit: Fit, other: Fit, target: float = np.inf) -> FitJob:
    """A fit's causes at its sizes, from the commissioning errors that another one found.

    Where parts stick and slip chi^2 is rough: from its own errors the search of a payload stopped
    at 9522, behind the mass of another body (9482), and from that one's errors at 9443 (VES II).

    Args:
        evidence: what was measured.
        fit: whose causes are free.
        other: whose commissioning errors it begins at.
        target: chi^2 that it must be able to come down to.
    """
    runs = evidence.runs
    at = np.concatenate([runs.indices(cause) for cause in (*other.causes, *fit.causes)])
    shift = other.shift.copy()
    shift[at] = fit.shift[at]
    begin = (shift, other.local, other.step_share)
    return FitJob(evidence, fit.causes, *begin, target=target, known=fit.columns)


def _starts(first: Assessment, suspect: Candidate) -> list[FloatArray]:
    """The screen's scaled size, and the unscaled size of the bank nearest to the record.

    One is enough of a cause that is linear: any size leads to the same.
    """
    hypothesis = first.screen.bank.hypotheses[suspect.hypothesis]
    if hypothesis.linear:
        return [suspect.sizes]
    rows = first.screen.bank.entries(suspect.hypothesis)
    match = first.screen.match(first.z)[rows]
    nearest = rows[np.argmax(2.0 * match - first.screen.power[rows])]
    other = first.screen.bank.sizes[nearest]
    apart = np.any(np.abs(other - suspect.sizes) > 0.3 * np.abs(suspect.sizes))
    return [suspect.sizes, other] if apart else [suspect.sizes]
