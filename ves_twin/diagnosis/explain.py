"""explain: fit the suspects with the full forward, one alone or two together, and judge them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.adequacy import Cell, cells, misfit
from ves_twin.diagnosis.assess import STRANGE, Assessment, pull_limit
from ves_twin.diagnosis.evidence import Evidence
from ves_twin.diagnosis.fit_job import FitJob
from ves_twin.diagnosis.forward import Hypothesis
from ves_twin.diagnosis.linearise import Linearisation, renewed
from ves_twin.diagnosis.null import Thresholds
from ves_twin.diagnosis.probability import probabilities
from ves_twin.diagnosis.refine import Fit, bare_residual, refine, residual_about
from ves_twin.diagnosis.runs import Progress, silent
from ves_twin.diagnosis.screen import Candidate, Screen
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.signature_library import build_bank

RIVAL_RATIO = 4.0
"""A fit with this many times the chi^2 of the best is not worth new nuisance columns."""

LEAST = 0.7
"""Part of the threshold that a cause must take off chi^2; a fit changes the screen's value."""

CLEAR = 3.0
"""Times the threshold that a cause must take off chi^2 to outweigh a better fit without it."""

FAR = 0.5
"""Share of the likeliest suspect's score that another must have to be fitted at once."""

CLOSE = 40.0
"""Or so near to it [chi^2]: four times the odds that settle a name."""

SHORTLIST = 16
"""Further causes that are simulated anew at a fit: all of a small library, a tenth of VES II's,
where what the nominal bank puts behind sixteen others does not come first at the fit."""

TOGETHER = 2
"""Causes that are looked for together here."""

HOPE = 0.5
"""Share of what is there that a cause, or a pair by the screen, must take to be gone on with."""

SLACK = 0.1
"""Share of chi^2 that a rough fit may still fall."""

WORSE_START = 2.0
"""Times the chi^2 of a fit from elsewhere from which one that has ended is not gone on with."""

PAIRS = 6
"""Pairs of causes that are fitted with the full forward."""


@dataclass(frozen=True)
class Explanation:
    """What the library makes of a record that is not in order.

    Attributes:
        evidence: with the whitening that the best fit's residual shows.
        commissioning: fit of commissioning errors alone.
        fits: by rising chi^2.
        chosen: those that are as good as the best, given its allowance, the best first.
        weights: probability of each of them, given the library.
        adequate: whether what the best leaves is noise.
        score: largest cell score it leaves.
        second: best score of a further cause beside it; None if nobody looked.
        before, after: cells without and with it.
        alone: fits of single causes, where only two together are adequate.
        hopeless: fits that were given up, under the first whitening.
        far: whether no cause takes HOPE of what is there, nor two of them by the screen.
    """

    evidence: Evidence
    commissioning: Fit
    fits: tuple[Fit, ...]
    chosen: tuple[Fit, ...]
    weights: tuple[float, ...]
    adequate: bool
    score: float
    second: float | None
    before: tuple[Cell, ...]
    after: tuple[Cell, ...]
    alone: tuple[Fit, ...] = ()
    hopeless: tuple[Fit, ...] = ()
    far: bool = False

    @property
    def best(self) -> Fit:
        """The most probable one."""
        return self.chosen[0]


@dataclass(frozen=True)
class FitContext:
    """What all stages work with."""

    first: Assessment
    thresholds: Thresholds
    settings: Settings
    progress: Progress


def explain(
    first: Assessment,
    thresholds: Thresholds,
    settings: Settings,
    progress: Progress = silent,
    pairs: bool = True,
) -> Explanation | None:
    """Single causes, then pairs where no single one leaves noise.

    Args:
        first: the record before any cause, over a threshold.
        thresholds: what noise and commissioning errors do.
        settings: how many and how much.
        progress: told how far it is.
        pairs: whether two causes together are tried.

    Returns:
        The best explanation, adequate or not; None if the library is empty or fits nothing.
    """
    desk = FitContext(first, thresholds, settings, progress)
    single = _singles(desk)
    if single is None or single.adequate or single.far or not pairs:
        return single
    return _pairs(desk, single) or single


def _singles(desk: FitContext) -> Explanation | None:
    """Suspects near the likeliest, two at least; all, where none of those leaves noise.

    Two, so that the page has a rival to show.
    """
    suspects = desk.first.suspects[: desk.settings.candidates]
    if not suspects:
        return None
    reach = suspects[0].score - max(FAR * suspects[0].score, CLOSE)
    near = [suspect for n, suspect in enumerate(suspects) if n < 2 or suspect.score >= reach]
    rest, fits = suspects[len(near) :], _tried(desk, near)
    if rest and _far(desk, fits):
        fits, rest = [*fits, *_tried(desk, rest)], []
    if _far(desk, fits):
        found = replace(judge(desk, fits, far=True), far=True)
    else:
        fits = _settled(desk.first.evidence, fits, desk)
        found = judge(desk, fits)
        if not found.adequate and rest:
            fits = _settled(desk.first.evidence, [*fits, *_tried(desk, rest)], desk)
            found = judge(desk, fits)
    judged = {fit.causes for fit in found.fits}
    return replace(found, hopeless=tuple(fit for fit in fits if fit.causes not in judged))


def _tried(desk: FitContext, suspects: list[Candidate]) -> list[Fit]:
    """Suspects fitted roughly, each from the sizes that it may have."""
    first = desk.first
    start = _start(first)
    jobs, owner = [], []
    for n, suspect in enumerate(suspects):
        hypothesis = first.screen.bank.hypotheses[suspect.hypothesis]
        for sizes in _starts(first, suspect):
            jobs.append(_job(first.evidence, (hypothesis,), [sizes], start))
            owner.append(n)
    tried = _refined(jobs, desk, "fitting single causes")
    return [
        min((f for f, o in zip(tried, owner, strict=True) if o == n), key=lambda fit: fit.chi2)
        for n in sorted(set(owner))
    ]


def _far(desk: FitContext, fits: list[Fit]) -> bool:
    """Whether what causes take is so little that neither new columns nor a second one would do.

    Of a machine of many parameters alone: of others runs are cheap, and laws may be looked for.
    """
    first, best = desk.first, min(fits, key=lambda fit: fit.chi2)
    if not desk.settings.sparse or desk.settings.causes > TOGETHER or first.commissioning is None:
        return False
    noise = len(best.residual)
    there = first.commissioning.chi2 - noise
    if best.chi2 - noise < (1.0 - HOPE) * there or best.chi2 < STRANGE * noise:
        return False
    power = float(first.z @ first.left)
    return all(one.score < HOPE * power for one, _ in first.screen.pairs(first.z, 1))


def _job(
    evidence: Evidence,
    causes: tuple[Hypothesis, ...],
    sizes: list[FloatArray],
    start: _Start,
) -> FitJob:
    """From a point and the columns there, with the causes at given sizes; roughly, at first."""
    runs, shift = evidence.runs, start.shift
    for cause, size in zip(causes, sizes, strict=True):
        shift = runs.depart(shift, runs.indices(cause), size)
    return FitJob(evidence, causes, shift, start.local, start.step_share, True)


def _refined(jobs: list[FitJob], desk: FitContext, what: str) -> list[Fit]:
    fits: list[Fit] = []
    for fit in desk.first.evidence.runs.workers.map(FitJob.run, jobs):
        desk.progress(len(fits) / len(jobs), what)
        fits.append(fit)
    return fits


@dataclass(frozen=True)
class _Start:
    """Where fits begin: commissioning errors, the columns there, the step's share."""

    shift: FloatArray
    local: Linearisation
    step_share: float = 0.0


def _start(first: Assessment) -> _Start:
    """Commissioning errors as the last look left them, and the newest columns."""
    last = first.commissioning
    if last is None:
        return _Start(first.evidence.runs.origin, first.screen.bank.base)
    return _Start(last.shift, last.local, last.step_share)


def _settled(evidence: Evidence, fits: list[Fit], desk: FitContext) -> list[Fit]:
    """Fits by columns computed at the leader: what rivals share of the commissioning errors.

    Hopeless rivals stay as they are. Where a rival leads then, once more at its own.
    """
    for _ in range(2):
        leader = min(fits, key=lambda fit: fit.chi2)
        settled = _again(evidence, leader, desk.settings.rounds)
        near = RIVAL_RATIO * settled.chi2
        others = [fit for fit in fits if fit is not leader]
        jobs = [FitJob.again(evidence, f, settled.local) for f in others if f.chi2 < near]
        rivals = _refined(jobs, desk, "fitting its rivals")
        fits = [settled, *rivals, *(fit for fit in others if fit.chi2 >= near)]
        if all(rival.chi2 >= settled.chi2 for rival in rivals):
            break
    return fits


def _again(evidence: Evidence, fit: Fit, rounds: int) -> Fit:
    """From where a fit ended, with columns computed there."""
    return refine(evidence, fit.causes, fit.shift, fit.local, rounds, fit.step_share)


def _starts(first: Assessment, suspect: Candidate) -> list[FloatArray]:
    """The screen's scaled size, and the unscaled size of the bank nearest to the record.

    One is enough of a cause that is linear: any size leads to the same.
    """
    if first.screen.bank.hypotheses[suspect.hypothesis].linear:
        return [suspect.sizes]
    rows = first.screen.bank.entries(suspect.hypothesis)
    match = first.screen.match(first.z)[rows]
    nearest = rows[np.argmax(2.0 * match - first.screen.power[rows])]
    other = first.screen.bank.sizes[nearest]
    apart = np.any(np.abs(other - suspect.sizes) > 0.3 * np.abs(suspect.sizes))
    return [suspect.sizes, other] if apart else [suspect.sizes]


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
    commissioning, rough = _commissioning(desk, evidence, leader, far)
    near = RIVAL_RATIO * leader.chi2
    jobs = [FitJob.again(evidence, fit) for fit in fits if fit.chi2 < near]
    if far:
        jobs = [replace(job, rough=True) for job in jobs]
    ranked = _refined(jobs, desk, "weighing rivals")
    ranked.sort(key=lambda fit: fit.chi2)
    best = ranked[0]
    taken = max(commissioning.chi2 - best.chi2, 0.0)
    sure = min(taken, best.power) if rough else taken
    doubt = settings.model_error * np.sqrt(sure / max(taken, 1e-30))
    allowance = doubt**2 * taken
    chosen, weights = probabilities(ranked, allowance, settings.odds)
    before = cells(own, commissioning.residual)
    after = cells(own, chosen[0].residual)
    score = misfit(after, before, float(doubt))
    beside = allowance + first.allowance
    second = None if far else _second(desk, evidence, chosen[0], beside)
    limit = desk.thresholds.effect + beside
    fall = commissioning.chi2 - chosen[0].chi2 - (taken - sure)
    strained = chosen[0].pull > pull_limit(first.screen.bank, settings.alpha)
    enough = fall > LEAST * desk.thresholds.effect and not strained and second is not None
    return Explanation(
        evidence=evidence,
        commissioning=commissioning,
        fits=tuple(ranked),
        chosen=tuple(chosen),
        weights=tuple(weights),
        adequate=enough and score < desk.thresholds.misfit and (second or 0.0) < limit,
        score=score,
        second=second,
        before=tuple(before),
        after=tuple(after),
    )


def _commissioning(
    desk: FitContext, evidence: Evidence, leader: Fit, far: bool
) -> tuple[Fit, bool]:
    """The best fit without a cause, from the first look and beside the leader; whether it is rough.

    Beside the leader: what it moves, where commissioning may have moved it too, stays. Columns are
    computed anew only where the cause takes off little.
    """
    first, runs = desk.first, evidence.runs
    shift, start = np.where(runs.sd > 0.0, leader.shift, 0.0), _start(first)
    sparse, last = desk.settings.sparse, first.commissioning
    job = FitJob(evidence, (), shift, leader.local, leader.step_share, sparse)
    best = _refined([job], desk, "commissioning errors alone")[0]
    if not sparse or last is None or last.chi2 < WORSE_START * best.chi2:
        job = FitJob(evidence, (), start.shift, start.local, start.step_share, sparse)
        alone = _refined([job], desk, "commissioning errors alone")[0]
        best = min(best, alone, key=lambda fit: fit.chi2)
    clear = leader.chi2 + CLEAR * desk.thresholds.effect
    if sparse and (far or best.chi2 > clear + SLACK * leader.chi2):
        return best, True
    best = _again(evidence, best, 0) if sparse else best
    return (best if best.chi2 > clear else _again(evidence, best, desk.settings.rounds)), False


def _second(desk: FitContext, evidence: Evidence, fit: Fit, allowance: float) -> float:
    """Best score of a further cause beside a fit: by the nominal bank, then by one at the fit."""
    bank = desk.first.screen.bank
    z = residual_about(evidence, fit, bank.base)
    score = Screen(bank, evidence.whitening, fit.free).suspects(z)[0].score
    if score < desk.thresholds.effect + allowance:
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


def _pairs(desk: FitContext, single: Explanation) -> Explanation | None:
    """Pairs from the bank in closed form, and second causes beside the two best single ones."""
    first, library = desk.first, desk.first.screen.bank.hypotheses
    starts: dict[frozenset[str], tuple[tuple[Hypothesis, ...], list[FloatArray]]] = {}

    def propose(causes: tuple[Hypothesis, ...], sizes: list[FloatArray]) -> None:
        starts.setdefault(frozenset(h.label for h in causes), (causes, sizes))

    for fit in single.fits[:2]:
        rest, suspects = suspects_at(desk, single.evidence, fit)
        for suspect in suspects[: PAIRS // 3]:
            if suspect.score > 0.0:
                propose((*fit.causes, rest[suspect.hypothesis]), [fit.sizes, suspect.sizes])
    for one, two in first.screen.pairs(first.z, PAIRS):
        propose((library[one.hypothesis], library[two.hypothesis]), [one.sizes, two.sizes])
    best = single.best
    errors = best.shift.copy()
    errors[best.active[: len(best.sizes)]] = 0.0
    jobs = [
        _job(single.evidence, causes, sizes, _Start(errors, best.local, best.step_share))
        for causes, sizes in list(starts.values())[:PAIRS]
    ]
    if not jobs:
        return None
    fits = _refined(jobs, desk, "fitting pairs of causes")
    double = judge(desk, _settled(single.evidence, fits, desk))
    fall = single.best.chi2 - double.best.chi2
    explained = max(double.commissioning.chi2 - double.best.chi2, 0.0)
    least = desk.thresholds.effect + desk.settings.model_error**2 * explained
    if not (double.adequate and fall > least):
        return None
    return replace(double, alone=(*single.fits, *single.hopeless))
