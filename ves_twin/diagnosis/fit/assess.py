"""assess: a record before any cause is named: what the screen sees, commissioning errors fitted."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import norm

from ves_twin.core.types import FloatArray, SingleArray
from ves_twin.diagnosis.bank.linearise import Linearisation
from ves_twin.diagnosis.bank.prewhitened import Prewhitened
from ves_twin.diagnosis.bank.screen import Candidate, Screen
from ves_twin.diagnosis.bank.signature_library import SignatureLibrary
from ves_twin.diagnosis.fit.refine import ROUGH, Fit, bare_residual, refine, residual_about
from ves_twin.diagnosis.fit.search import BETTER_FITS, FARTHEST, ITERATIONS, RELATIVE_CONVERGENCE
from ves_twin.diagnosis.record.adequacy import cells, misfit
from ves_twin.diagnosis.record.evidence import Evidence
from ves_twin.diagnosis.record.runs import Progress, silent
from ves_twin.diagnosis.record.whitening import Whitening

ROUNDS = 3
"""Linearisations at most for the commissioning errors of one record."""

BEYOND = 1.5
"""Times its limit above which a score after a fit is a cause's: new columns move it by a tenth."""

GLANCE = 2
"""Steps of a first fit of commissioning errors: a rig in order is mostly known after them."""

FAR = 4.0
"""chi^2 for each sample from which new columns of commissioning errors are not worth their runs."""

STRANGE = 1.5
"""chi^2 for each sample beside the best hypothesis above which it is not taken for the cause."""


ASTRAY = 2.0
"""chi^2 for each sample that noise and fitted commissioning errors do not leave."""


@dataclass(frozen=True)
class Assessment:
    """A record before any cause is fitted.

    Attributes:
        evidence: with the whitening as the record itself has it.
        screen: the bank under that whitening.
        z: whitened residual about the bank's base (samples,).
        left: z less what the nuisances explain.
        suspects: hypotheses by falling score.
        misfit: largest cell score.
        commissioning: fit of commissioning errors alone, or those that were fitted beside the
            likeliest cause, without it; None while it was not needed.
        bends: relative error of what fitted commissioning errors explain.
        beside: the likeliest cause with them, where it was fitted and leaves noise.
    """

    evidence: Evidence
    screen: Screen
    z: FloatArray
    left: FloatArray
    suspects: list[Candidate]
    misfit: float
    commissioning: Fit | None
    bends: float = 0.0
    beside: Fit | None = None

    @property
    def score(self) -> float:
        """The best hypothesis's chi^2."""
        return self.suspects[0].score if self.suspects else 0.0

    @property
    def pull(self) -> float:
        """Largest most probable commissioning error, in declared sd (the step's share is none)."""
        errors = self.screen.metric.nuisances(self.z)[: len(self.evidence.runs.nuisances)]
        return float(np.max(np.abs(errors), initial=0.0))

    @property
    def told(self) -> bool:
        """Whether noise is most of what the best hypothesis would leave.

        Else commissioning errors are still far from their values, and the screen sees those.
        """
        fit = self.commissioning
        return fit is not None and fit.chi2 - self.score < STRANGE * len(fit.residual)

    @property
    def allowance(self) -> float:
        """chi^2 that may stay of what commissioning errors explain, since they bend: a share."""
        explained = float(self.z @ self.z - self.left @ self.left)
        return self.bends**2 * max(explained, 0.0)

    def limit(self, effect: float) -> float:
        """The score beyond which something is there, `effect` being what noise does."""
        return effect + self.allowance

    @property
    def astray(self) -> bool:
        """Whether more than noise is left, whatever simulated rigs in order leave."""
        return float(self.left @ self.left) > ASTRAY * float(np.sum(self.screen.whitening.freedom))

    def exceeds(self, effect: float, misfit: float, pull: float) -> bool:
        """Whether something is there."""
        louder = self.score > self.limit(effect)
        return louder or self.misfit > misfit or self.pull > pull


def assess(
    measured: SingleArray,
    bank: SignatureLibrary,
    whitening: Whitening,
    effect: float,
    level: float,
    pull: float,
    bends: float = 0.0,
    sparse: bool = False,
    progress: Progress = silent,
) -> Assessment:
    """Screen a record; where it looks faulty, once more with the nuisances fitted in full.

    Args:
        measured: channels on the grid (rows, c).
        bank: the library's signatures.
        whitening: noise as declared or measured.
        effect: score that leads to the second look.
        level: misfit that leads to it.
        pull: commissioning error [sd] that leads to it.
        bends: relative error of what fitted commissioning errors explain.
        sparse: whether a record that stays far from noise is fitted roughly, as a machine of many
            parameters needs.
        progress: told how far it is.
    """
    runs = bank.base.runs
    shaped = Prewhitened(bank, whitening)
    first = replace(first_look(measured, shaped), bends=bends)
    if not (first.astray or first.exceeds(effect, level, pull)):
        return first
    look = first
    looks = ((0, GLANCE), (0, ITERATIONS), (ROUNDS, ITERATIONS))
    for n, (rounds, steps) in enumerate(looks):
        progress(n / len(looks), "fitting the tolerances")
        if (sparse and rounds and _left(look) > FAR) or (n and runs.budget.skips(BETTER_FITS)):
            break
        rough = sparse and _left(look) > STRANGE
        within = pull if steps == GLANCE else FARTHEST  # few steps may lead far astray
        fit = _fitted(look, rounds, steps, ROUGH if rough else RELATIVE_CONVERGENCE, within)
        own = whitening.adapted(whitening.apply(bare_residual(look.evidence, fit)))
        look = _look(Evidence(runs, measured, own), Screen(bank, own, shaped=shaped), fit)
        look = replace(look, bends=bends)
        if not (look.astray or look.exceeds(effect, level, pull)):
            break
        if look.score <= BEYOND * look.limit(effect):
            continue
        if steps == GLANCE:
            beside = _beside(first, look, pull)
            if beside is not None:
                own = whitening.adapted(whitening.apply(bare_residual(look.evidence, beside)))
                screen = Screen(bank, own, shaped=shaped)
                fit = _without_causes(look.evidence, beside)
                look = _look(Evidence(runs, measured, own), screen, fit)
                return replace(look, bends=bends, beside=beside)
        elif look.told:
            break
    return look


def _beside(first: Assessment, look: Assessment, pull: float) -> Fit | None:
    """The likeliest cause fitted with the commissioning errors; None if it leaves more than noise.

    None, too, if it strains one: of three rigs in order a cause that was not there left noise, with
    commissioning errors of 7 to 10 sd beside it.

    Commissioning errors alone, held against a loud fault, take hundreds of runs to mimic it, and
    tell no more of its name.
    """
    base, tried = look.screen.bank.base, set[int]()
    for seen in (look, first):
        suspect = seen.suspects[0]
        if suspect.hypothesis in tried:
            break
        tried.add(suspect.hypothesis)
        cause = look.screen.bank.hypotheses[suspect.hypothesis]
        shift = base.runs.depart(base.runs.origin, base.runs.indices(cause), suspect.sizes)
        fit = refine(seen.evidence, (cause,), shift, base, enough=ROUGH)
        if fit.chi2 < STRANGE * len(fit.residual) and fit.pull <= pull:
            return fit
    return None


def _without_causes(evidence: Evidence, fit: Fit) -> Fit:
    """The commissioning errors of a fit, its causes taken out: one run, nothing fitted."""
    shift = fit.shift.copy()
    shift[fit.active[: len(fit.sizes)]] = 0.0
    return refine(evidence, (), shift, fit.local, 0, fit.step_share, steps=0)


def first_look(measured: SingleArray, shaped: Prewhitened) -> Assessment:
    """With the nuisances as the linearisation at nominal has them, and the record's own noise."""
    bank, whitening = shaped.bank, shaped.whitening
    raw = whitening.apply(measured - bank.base.prediction)
    own = whitening.adapted(shaped.metric.project(raw))
    return _look(Evidence(bank.base.runs, measured, own), Screen(bank, own, shaped=shaped), None)


def _left(look: Assessment) -> float:
    """What commissioning errors leave: chi^2 for each sample; 0 before they were fitted."""
    fit = look.commissioning
    return 0.0 if fit is None else fit.chi2 / len(fit.residual)


def _fitted(look: Assessment, rounds: int, steps: int, enough: float, within: float) -> Fit:
    """Commissioning errors alone, from where the last look left them."""
    base = look.screen.bank.base
    at: tuple[FloatArray, Linearisation, int, float] = (base.runs.origin, base, rounds, 0.0)
    if look.commissioning is not None:
        last = look.commissioning
        at = (last.shift, last.local, rounds, last.step_share)
    return refine(look.evidence, (), *at, farthest=within, steps=steps, enough=enough)


def _look(evidence: Evidence, screen: Screen, fit: Fit | None) -> Assessment:
    base = screen.bank.base
    if fit is None:
        z = evidence.whitening.apply(evidence.measured - base.prediction)
    else:
        z = residual_about(evidence, fit, base)
    left = screen.metric.project(z)
    worst = misfit(cells(evidence.whitening, left))
    return Assessment(evidence, screen, z, left, screen.suspects(z), worst, fit)


def pull_limit(bank: SignatureLibrary, alpha: float) -> float:
    """Declared sd that the largest commissioning error of a rig in order passes with alpha.

    It catches what the library lacks and the commissioning parameters would swallow: a cause that
    was left out, or a tolerance that is wrong.
    """
    return float(norm.isf(alpha / (2.0 * max(len(bank.base.runs.nuisances), 1))))
