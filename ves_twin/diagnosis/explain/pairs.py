"""pairs, strained_pair: two causes together, unless either does as well alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.bank.screen import Screen
from ves_twin.diagnosis.explain.judge import judge, suspects_at
from ves_twin.diagnosis.fit.assess import STRANGE, pull_limit
from ves_twin.diagnosis.fit.explanation import Explanation
from ves_twin.diagnosis.fit.fit_context import FitContext
from ves_twin.diagnosis.fit.fits import Start, job, refined, settled
from ves_twin.diagnosis.fit.refine import Fit, refine, residual_about
from ves_twin.diagnosis.model.forward import Hypothesis
from ves_twin.diagnosis.record.evidence import Evidence

PAIRS = 6
"""Pairs of causes that are fitted with the full forward."""

HALF = 0.5
"""Share of what a second cause must take off, below which rough fits show that it will not."""

Proposal = tuple[tuple[Hypothesis, ...], list[FloatArray]]
"""Causes, and a size of each to begin at."""


def pairs(desk: FitContext, single: Explanation) -> Explanation | None:
    """Pairs from the bank in closed form, and second causes beside the two best single ones.

    Args:
        desk: the record before any cause.
        single: what single causes make of it.

    Returns:
        Two causes that leave noise and take more off than one, or the one of them that does as
        well from the errors beside both; None if there are none.
    """
    proposed: list[Proposal] = []
    for fit in single.fits[:2]:
        rest, suspects = suspects_at(desk, single.evidence, fit)
        for suspect in suspects[: PAIRS // 3]:
            if suspect.score > 0.0:
                causes = (*fit.causes, rest[suspect.hypothesis])
                proposed.append((causes, [fit.sizes, suspect.sizes]))
    fits = _fitted(desk, single.evidence, [*proposed, *_screened(desk)], single.best)
    if not fits:
        return None
    double = judge(desk, settled(single.evidence, fits, desk))
    if not double.adequate:
        return None
    alone = [_alone(double, cause) for cause in double.best.causes]
    others = (*single.fits, *single.hopeless)
    return _better(desk, double, single.best.chi2, alone, others)


def strained_pair(desk: FitContext, fits: Sequence[Fit]) -> Explanation | None:
    """The likeliest cause with the one whose commissioning error it strains, if that is a cause.

    A record of both is near noise with the louder one alone, which the other's tolerance makes up
    for; columns and rivals of single causes would tell that at the cost of a diagnosis.

    Args:
        desk: the record before any cause.
        fits: rough ones of single causes.

    Returns:
        As `pairs`; None also where the first cause alone turns out to need no such error.
    """
    first, leader = desk.first, min(fits, key=lambda fit: fit.chi2)
    evidence, bank = first.evidence, first.screen.bank
    limit = pull_limit(bank, desk.settings.alpha)
    other = _strained(desk, leader) if leader.pull > limit else None
    if other is None or leader.chi2 > STRANGE * len(leader.residual):
        return None
    causes = (*leader.causes, other)
    proposed: list[Proposal] = [
        (causes, [leader.sizes, leader.shift[evidence.runs.indices(other)]])
    ]
    about = residual_about(evidence, leader, bank.base)
    for suspect in Screen(bank, evidence.whitening, leader.free).suspects(about)[: PAIRS // 3]:
        beside = bank.hypotheses[suspect.hypothesis]
        if beside not in causes:
            proposed.append(((*leader.causes, beside), [leader.sizes, suspect.sizes]))
    tried = _fitted(desk, evidence, proposed, leader)
    least = desk.thresholds.effect + desk.settings.model_error**2 * leader.power
    if leader.chi2 - min(fit.chi2 for fit in tried) < HALF * least:
        return None
    double = judge(desk, settled(evidence, tried, desk, tried[0]))
    alone = _alone(double, leader.causes[0])
    if not (double.adequate and alone.pull > limit):
        return None
    rest = [_alone(double, cause) for cause in double.best.causes if cause != leader.causes[0]]
    others = tuple(fit for fit in fits if fit is not leader)
    return _better(desk, double, alone.chi2, [alone, *rest], others)


def _alone(double: Explanation, cause: Hypothesis) -> Fit:
    """One cause of a pair, from the commissioning errors beside both; the other is one of them."""
    best, runs = double.best, double.evidence.runs
    shift, kept = np.where(runs.sd > 0.0, best.shift, 0.0), runs.indices(cause)
    shift[kept] = best.shift[kept]
    return refine(double.evidence, (cause,), shift, best.local, 0, best.step_share)


def _strained(desk: FitContext, fit: Fit) -> Hypothesis | None:
    """The cause whose commissioning error a fit strains most; None if that is of no cause."""
    runs = desk.first.evidence.runs
    errors = np.setdiff1d(fit.active[len(fit.sizes) :], fit.active[: len(fit.sizes)])
    worst = errors[np.argmax(np.abs(fit.shift[errors]) / runs.sd[errors])]
    name = runs.coordinates[worst].parameter.name
    found = (h for h in desk.first.screen.bank.hypotheses if h.parameters == (name,))
    return next(found, None)


def _screened(desk: FitContext) -> list[Proposal]:
    """Pairs by the screen."""
    first, library = desk.first, desk.first.screen.bank.hypotheses
    return [
        ((library[one.hypothesis], library[two.hypothesis]), [one.sizes, two.sizes])
        for one, two in first.screen.pairs(first.z, PAIRS)
    ]


def _fitted(
    desk: FitContext, evidence: Evidence, proposed: Sequence[Proposal], single: Fit
) -> list[Fit]:
    """The first PAIRS that differ, roughly, from the commissioning errors beside a single cause."""
    starts: dict[frozenset[str], Proposal] = {}
    for causes, sizes in proposed:
        starts.setdefault(frozenset(h.label for h in causes), (causes, sizes))
    errors = single.shift.copy()
    errors[single.active[: len(single.sizes)]] = 0.0
    begin = Start(errors, single.local, single.step_share)
    jobs = [job(evidence, *start, begin) for start in list(starts.values())[:PAIRS]]
    return refined(jobs, desk, "fitting pairs of causes")


def _better(
    desk: FitContext,
    double: Explanation,
    single: float,
    alone: Sequence[Fit],
    others: tuple[Fit, ...],
) -> Explanation | None:
    """A pair, which leaves noise, if it takes more off than a second cause must; else one of it.

    A single cause that stopped short is no worse than a pair with another one beside it: each of a
    pair's causes is fitted from the errors beside both. One that strains a tolerance is not alone.

    Args:
        desk: thresholds.
        double: the pair.
        single: chi^2 of the best single cause before.
        alone: fits of the pair's causes.
        others: fits of single causes before.
    """
    least = desk.thresholds.effect + double.allowance
    if single - double.best.chi2 <= least:
        return None
    limit = pull_limit(desk.first.screen.bank, desk.settings.alpha)
    new = {fit.causes for fit in alone}
    others = tuple(fit for fit in others if fit.causes not in new)
    best = min(alone, key=lambda fit: fit.chi2)
    if best.chi2 - double.best.chi2 <= least and best.pull <= limit:
        found = judge(desk, [*alone, *others])
        known = {fit.causes for fit in found.fits}
        rest = tuple(fit for fit in others if fit.causes not in known)
        if found.adequate:
            return replace(found, hopeless=rest)
    return replace(double, alone=(*alone, *others))
