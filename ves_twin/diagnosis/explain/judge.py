"""judge: what fits are worth: noise as the best leaves it, rivals weighed, the rest tested."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ves_twin.diagnosis.bank.linearise import renewed
from ves_twin.diagnosis.bank.screen import Candidate, Screen
from ves_twin.diagnosis.bank.signature_library import build_bank
from ves_twin.diagnosis.explain.probability import probabilities
from ves_twin.diagnosis.fit.assess import pull_limit
from ves_twin.diagnosis.fit.explanation import Explanation
from ves_twin.diagnosis.fit.fit_context import FitContext
from ves_twin.diagnosis.fit.fit_job import FitJob
from ves_twin.diagnosis.fit.fits import again, crossed, is_near, refined, start_of, within_reach
from ves_twin.diagnosis.fit.refine import Fit, bare_residual, refine, residual_about
from ves_twin.diagnosis.fit.search import FARTHEST
from ves_twin.diagnosis.model.forward import Hypothesis
from ves_twin.diagnosis.record.adequacy import cells, misfit
from ves_twin.diagnosis.record.evidence import Evidence

LEAST = 0.7
"""Part of the threshold that a cause must take off chi^2; a fit changes the screen's value."""

CLEAR = 3.0
"""Times the threshold that a cause must take off chi^2 to outweigh a better fit without it."""

SHORTLIST = 16
"""Further causes that are simulated anew at a fit: all of a small library, a tenth of VES II's,
where what the nominal bank puts behind sixteen others does not come first at the fit."""

SLACK = 0.1
"""Share of chi^2 that a rough fit may still fall."""

WORSE_START = 2.0
"""Times the chi^2 of a fit from elsewhere from which one that has ended is not gone on with."""


def judge(desk: FitContext, fits: list[Fit], far: bool = False) -> Explanation:
    """Whiten by what the best fit leaves, fit again, weigh the rivals, test what is left.

    Args:
        desk: the record before any cause.
        fits: under the first whitening.
        far: whether all are so far off that they are weighed roughly, and no other is looked for.
    """
    first, settings = desk.first, desk.settings
    runs = first.evidence.runs
    leader = min(fits, key=lambda fit: fit.chi2)
    declared = first.screen.whitening
    white, unit = np.zeros_like(declared.colour), np.ones_like(declared.level)
    plain = replace(declared, colour=white, level=unit)
    own = plain.adapted(plain.apply(bare_residual(first.evidence, leader)))
    evidence = Evidence(runs, first.evidence.measured, own)
    ranked = _ranked(desk, evidence, leader, [fit for fit in fits if is_near(fit, leader)], far)
    leads = leader if ranked[0].causes == leader.causes else ranked[0]
    commissioning, rough = _commissioning(desk, evidence, leads, far)
    limit_of_pull = pull_limit(first.screen.bank, settings.alpha)
    if not far and ranked[0].pull > limit_of_pull:
        ranked = sorted([_relaxed(evidence, ranked[0]), *ranked[1:]], key=_chi2)
    best = ranked[0]
    taken = max(commissioning.chi2 - best.chi2, 0.0)
    sure = min(taken, best.power) if rough else taken
    doubt = settings.model_error * np.sqrt(sure / max(taken, 1e-30))
    allowance = doubt**2 * taken
    clear = desk.thresholds.effect + allowance + first.allowance
    ranked = ranked if far else _held(evidence, ranked, limit_of_pull, clear)
    chosen, weights = probabilities(ranked, allowance, settings.odds)
    before = cells(own, commissioning.residual)
    after = cells(own, chosen[0].residual)
    score = misfit(after, before, float(doubt))
    second = None if far else _second(desk, evidence, chosen[0], clear)
    fall = commissioning.chi2 - chosen[0].chi2 - (taken - sure)
    strained = chosen[0].pull > limit_of_pull
    enough = fall > LEAST * desk.thresholds.effect and not strained and second is not None
    return Explanation(
        evidence=evidence,
        commissioning=commissioning,
        fits=tuple(ranked),
        chosen=tuple(chosen),
        weights=tuple(weights),
        adequate=enough and score < desk.thresholds.misfit and (second or 0.0) < clear,
        score=score,
        second=second,
        allowance=float(allowance),
        after=tuple(after),
    )


def _ranked(
    desk: FitContext, evidence: Evidence, leader: Fit, fits: list[Fit], rough: bool
) -> list[Fit]:
    """Fits under another noise by rising chi^2, the leader's first: it says what counts.

    Rivals are searched from where they ended, and from the leader's commissioning errors: what one
    of them finds there, another may have missed. The leader, if it loses, from the best rival's.
    """
    what = "weighing rivals"
    best = refined([replace(FitJob.again(evidence, leader), rough=rough)], desk, what)[0]
    target = within_reach(best, desk)
    rivals = [FitJob.again(evidence, fit, target=target) for fit in fits if fit is not leader]
    found = refined([replace(job, rough=rough) for job in rivals], desk, what)
    if (
        rough
        or not found
        or evidence.runs.budget.skips("rivals from the commissioning errors of the best")
    ):
        return sorted([best, *found], key=_chi2)
    others = refined([crossed(evidence, fit, best, target) for fit in found], desk, what)
    found = [min(pair, key=_chi2) for pair in zip(found, others, strict=True)]
    first = min(found, key=_chi2)
    if first.chi2 < best.chi2:
        best = min(best, *refined([crossed(evidence, best, first)], desk, what), key=_chi2)
    return sorted([best, *found], key=_chi2)


def _chi2(fit: Fit) -> float:
    return fit.chi2


def _relaxed(evidence: Evidence, fit: Fit) -> Fit:
    """A strained fit gone on with along what it knows least; as it was where that leaves more.

    Columns that are a little off bind a direction that the record leaves open: a crane's forces and
    masses of one share stayed 4 % low, 3.9 sd of a gain, where friction alone leaves noise.
    """
    at = (fit.shift, fit.local, 0, fit.step_share)
    probed = refine(evidence, fit.causes, *at, probed=True)
    return min(fit, probed, key=lambda one: one.chi2)


def _held(evidence: Evidence, ranked: list[Fit], limit: float, clear: float) -> list[Fit]:
    """Fits by rising chi^2, those near the first with errors that a rig in order may have.

    An error beyond the limit is one more thing that is wrong, and is taken for that where it takes
    as much off chi^2 as a further cause must. Less than that the simulation of a loud cause may be
    wrong by: 4.1 sd of errors make up for the integrator beside a joint spring of 3800 sigma, where
    3.5 are allowed. Whatever may be the most probable in the end is held, not the first alone.

    Args:
        evidence: whose chi^2 counts.
        ranked: by rising chi^2.
        limit: of commissioning errors [sd].
        clear: chi^2 that a further cause must take off.
    """
    within = limit * (1.0 - 1e-9)  # errors that are held stand at the limit, to rounding
    found = []
    for fit in ranked:
        if fit.pull > limit and fit.chi2 <= ranked[0].chi2 + clear:
            at = (fit.shift, fit.local, 0, fit.step_share)
            held = refine(evidence, fit.causes, *at, farthest=within)
            fit = held if held.chi2 <= fit.chi2 + clear else fit
        found.append(fit)
    return sorted(found, key=_chi2)


def _commissioning(
    desk: FitContext, evidence: Evidence, leader: Fit, far: bool
) -> tuple[Fit, bool]:
    """The best fit without a cause, from the first look and beside the leader; whether it is rough.

    Beside the leader: what it moves, where commissioning may have moved it too, stays. Columns are
    computed anew only where the cause takes off little. Where runs are dear it is a rough fit of
    errors that a rig in order may have, gone on with only where that, too, is little.
    """
    first, runs = desk.first, evidence.runs
    shift, begin = np.where(runs.sd > 0.0, leader.shift, 0.0), start_of(first)
    sparse, last = desk.settings.sparse, first.commissioning
    farthest = pull_limit(first.screen.bank, desk.settings.alpha) if sparse else FARTHEST
    job = FitJob(evidence, (), shift, leader.local, leader.step_share, sparse, farthest=farthest)
    best = refined([job], desk, "commissioning errors alone")[0]
    elsewhere = first.beside is None or first.beside.causes != leader.causes
    if not sparse or last is None or (elsewhere and last.chi2 < WORSE_START * best.chi2):
        job = replace(job, shift=begin.shift, local=begin.local, step_share=begin.step_share)
        alone = refined([job], desk, "commissioning errors alone")[0]
        best = min(best, alone, key=lambda fit: fit.chi2)
    clear = leader.chi2 + CLEAR * desk.thresholds.effect
    if sparse and (far or best.chi2 > clear + SLACK * leader.chi2):
        return best, True
    best = again(evidence, best, 0) if sparse else best
    return (best if best.chi2 > clear else again(evidence, best, desk.settings.rounds)), False


def _second(desk: FitContext, evidence: Evidence, fit: Fit, clear: float) -> float:
    """Best score of a further cause beside a fit: by the nominal bank, then by one at the fit."""
    bank = desk.first.screen.bank
    z = residual_about(evidence, fit, bank.base)
    score = Screen(bank, evidence.whitening, fit.free).suspects(z)[0].score
    if score < clear or evidence.runs.budget.over:
        return score
    return max((s.score for s in suspects_at(desk, evidence, fit)[1]), default=0.0)


def suspects_at(
    desk: FitContext, evidence: Evidence, fit: Fit
) -> tuple[tuple[Hypothesis, ...], list[Candidate]]:
    """Further causes as a bank linearised at a fit sees them: the likeliest by the nominal bank."""
    bank = desk.first.screen.bank
    about = residual_about(evidence, fit, bank.base)
    likely = Screen(bank, evidence.whitening, fit.free).suspects(about)
    others = [bank.hypotheses[s.hypothesis] for s in likely]
    rest = tuple(h for h in others if h not in fit.causes)[:SHORTLIST]
    base = renewed(fit.local, fit.shift, fit.prediction)
    local = build_bank(evidence.runs, fit.shift, rest, desk.progress, base, desk.settings.sparse)
    z = residual_about(evidence, fit, local.base)
    return rest, Screen(local, evidence.whitening, fit.free).suspects(z)
