"""follow: one cause's size in every recording, fitted by the full forward, the rig shared."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.core.workers import Workers
from ves_twin.diagnosis.fit.refine import Fit, bare_residual, refine
from ves_twin.diagnosis.model.forward import Hypothesis
from ves_twin.diagnosis.record.adequacy import cells, misfit
from ves_twin.diagnosis.record.evidence import Evidence
from ves_twin.diagnosis.trend.day import Day
from ves_twin.diagnosis.trend.one_rig import Sharing

WORTH = 4.0
"""chi^2 from which a recording's screen says where the fit of a cause begins; below, at zero."""

RIDGE = 1e-10
"""Share of a scaled covariance that keeps it invertible where a day tells nothing."""


@dataclass(frozen=True)
class DayFit:
    """One cause in one recording, all commissioning errors fitted beside it.

    Attributes:
        chi2: there, with the pull of all commissioning errors.
        plain: chi^2 of commissioning errors alone, noise as the cause leaves it.
        score: largest cell score that is left.
        information: on the size, then on the shared parameters in commissioning sd (1 + p, 1 + p).
        weight: information times the most probable point (1 + p,).
        shared: names of those parameters.
    """

    chi2: float
    plain: float
    score: float
    information: FloatArray
    weight: FloatArray
    shared: tuple[str, ...]

    @property
    def sharing(self) -> Sharing:
        """On the shared parameters, whatever the size is."""
        a, g = self.information, self.weight
        across = a[1:, 0] / a[0, 0] if a[0, 0] > 0.0 else 0.0 * a[1:, 0]
        return Sharing(a[1:, 1:] - np.outer(across, a[0, 1:]), g[1:] - across * g[0])


@dataclass(frozen=True)
class Followed:
    """One cause in all recordings of one rig.

    Attributes:
        cause: which one.
        sizes: departures of its parameter, not held to its bounds (n,).
        covariance: of them, shared and own commissioning errors marginalised (n, n).
        days: fit of each recording.
        chi2: of all together, the shared parameters one for all.
    """

    cause: Hypothesis
    sizes: FloatArray
    covariance: FloatArray
    days: tuple[DayFit, ...]
    chi2: float


@dataclass(frozen=True)
class _Job:
    day: Day
    cause: Hypothesis
    rounds: int
    model_error: float

    @staticmethod
    def run(job: _Job) -> DayFit:
        return _fitted(job.day, job.cause, job.rounds, job.model_error)


def follow(
    days: Sequence[Day], cause: Hypothesis, workers: Workers, rounds: int, model_error: float
) -> Followed:
    """Sizes of a cause of one parameter on all days.

    Each recording is fitted by itself; what it tells of size and shared parameters, its prior on
    them taken off, is then put together with that prior once. Shared parameters may so be wrong
    by a whole commissioning sd without parting the days.

    Args:
        days: of one rig.
        cause: whose size may differ from day to day.
        workers: that share the days out.
        rounds: linearisations at most at a fit.
        model_error: relative error of the simulated change that may stay.
    """
    jobs = [_Job(day, cause, rounds, model_error) for day in days]
    fits = tuple(workers.map(_Job.run, jobs))
    n, names = len(fits), fits[0].shared
    p = len(names)
    whole, weight = np.zeros((n + p, n + p)), np.zeros(n + p)
    whole[n:, n:] = np.eye(p)
    for k, fit in enumerate(fits):
        at = np.array([k, *range(n, n + p)])
        whole[np.ix_(at, at)] += fit.information
        weight[at] += fit.weight
    scale = 1.0 / np.sqrt(np.maximum(np.diag(whole), 1e-300))
    scaled = whole * np.outer(scale, scale) + RIDGE * np.eye(n + p)
    covariance = np.linalg.inv(scaled) * np.outer(scale, scale)
    sizes = (covariance @ weight)[:n]
    return Followed(cause, sizes, covariance[:n, :n], fits, _joint_chi2(fits))


def _joint_chi2(fits: Sequence[DayFit]) -> float:
    """Sum of the days, and what it costs that they share one machine."""
    total = sum(fit.chi2 for fit in fits)
    parts = [fit.sharing for fit in fits]
    one = np.eye(len(fits[0].shared))
    alone = sum(float(s.score @ np.linalg.solve(one + s.information, s.score)) for s in parts)
    score = np.sum([s.score for s in parts], axis=0)
    whole = one + np.sum([s.information for s in parts], axis=0)
    return total + alone - float(score @ np.linalg.solve(whole, score))


def _fitted(day: Day, cause: Hypothesis, rounds: int, model_error: float) -> DayFit:
    look = day.look
    runs, base = look.evidence.runs, look.screen.bank.base
    fit = look.commissioning
    shift, local = (runs.origin, base) if fit is None else (fit.shift, fit.local)
    begin = runs.depart(shift, runs.indices(cause), _start(day, cause))
    first = refine(look.evidence, (cause,), begin, local, rounds)
    declared = look.screen.whitening
    blank = replace(declared, colour=0.0 * declared.colour, level=0.0 * declared.level + 1.0)
    own = blank.adapted(blank.apply(bare_residual(look.evidence, first)))
    evidence = Evidence(runs, look.evidence.measured, own)
    best = refine(evidence, (cause,), first.shift, first.local)
    plain = refine(evidence, (), shift, local)
    score = misfit(cells(own, best.residual), cells(own, plain.residual), model_error)
    return _told(best, evidence, plain.chi2, score)


def _start(day: Day, cause: Hypothesis) -> FloatArray:
    """The screen's size where it sees the cause, else none."""
    for suspect in day.look.suspects:
        if day.bank.hypotheses[suspect.hypothesis] == cause and suspect.score > WORTH:
            return suspect.sizes
    return np.zeros(1)


def _told(fit: Fit, evidence: Evidence, plain: float, score: float) -> DayFit:
    """What a fit tells of size and shared parameters, the prior of those taken off.

    One Newton step is taken from where the search ended, whatever the bounds say: a search ends
    when chi^2 hardly falls, which is tenths of a sd away, and a size that is held at a bound would
    leave days without an effect above zero.
    """
    runs = fit.local.runs
    sd = np.concatenate([[1.0], runs.sd[fit.active[1:]]])
    kept = np.flatnonzero(~np.isin(runs.nuisances, fit.active[:1]))
    columns = evidence.whitening.apply(fit.local.columns[kept]).T
    here = fit.shift[fit.active] / sd
    gradient = np.concatenate([fit.free.T, columns.T]) @ fit.residual
    gradient[1:] -= here[1:]
    whole = fit.posterior / np.outer(sd, sd)
    shared = [n for n, i in enumerate(fit.active) if n and runs.coordinates[int(i)].recording == -1]
    at = np.array([0, *shared])
    point = (here + whole @ gradient)[at]
    posterior = whole[np.ix_(at, at)]
    spread = np.sqrt(np.diag(posterior))
    scaled = posterior / np.outer(spread, spread) + RIDGE * np.eye(len(at))
    information = np.linalg.inv(scaled) / np.outer(spread, spread)
    weight = information @ point
    information[np.arange(1, len(at)), np.arange(1, len(at))] -= 1.0
    names = tuple(runs.coordinates[int(i)].parameter.name for i in fit.active[shared])
    return DayFit(fit.chi2, plain, score, information, weight, names)
