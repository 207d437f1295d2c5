"""decide: from an explanation and held-out recordings to the kind of verdict."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ves_twin.core.budget import EndedError
from ves_twin.core.recording.recording import Recording
from ves_twin.diagnosis.build_up.build_up import Built, build_up
from ves_twin.diagnosis.build_up.builder import Start
from ves_twin.diagnosis.build_up.halves import split
from ves_twin.diagnosis.build_up.inverse_start import inverse_start
from ves_twin.diagnosis.explain.explain import explain
from ves_twin.diagnosis.fit.assess import pull_limit
from ves_twin.diagnosis.fit.explanation import Explanation
from ves_twin.diagnosis.fit.fit_context import FitContext
from ves_twin.diagnosis.fit.fit_job import FEW
from ves_twin.diagnosis.fit.on_line import on_line
from ves_twin.diagnosis.fit.profile import profiled
from ves_twin.diagnosis.fit.refine import ROUGH, Fit, refine
from ves_twin.diagnosis.fit.search import ITERATIONS
from ves_twin.diagnosis.fit.spread import spread
from ves_twin.diagnosis.model.forward import Forward
from ves_twin.diagnosis.record.preprocess import Dataset
from ves_twin.diagnosis.record.whitening import whitening_of
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.unseen.forecast import forecast
from ves_twin.diagnosis.unseen.gain import Gain
from ves_twin.diagnosis.unseen.held_out import HeldOut
from ves_twin.diagnosis.verdict.verdict import Kind

ALMOST = 0.95
"""The same of a single cause that leaves more than noise: a wrong one that moves the same channels
takes up to nine tenths (viscous damping of a drag with the square of speed, of blind pendulums)."""

EXPLAINED, CHOSEN, BUILT = 0.3, 0.6, 0.8
"""Shares of the time after which single causes and pairs, and then choosing many, must end: a
search without time takes no step, and a satellite's mass centre came out ten times too large.
Where no more than two are asked for, they may have what choosing does not take."""

AT_LIMIT = 1.0 + 1e-9
"""Rounding of a commissioning error that a fit has held at its limit."""

MORE = 2.0
"""Chi^2 a sample from which an explanation that passes leaves more than noise."""

ONE_BY_ONE = "causes that are proved one by one"
"""What is left out where the work is ended before they could be chosen."""

MANY_FROM = 2
"""Causes beyond which more may be at work than a search of single ones and pairs can see."""


@dataclass(frozen=True)
class Conclusion:
    """What a record that is not in order comes to.

    Attributes:
        found: the best explanation; None if nothing fits.
        kind: of the verdict.
        gain: on held-out recordings.
        forecast: gain ahead in time, of causes whose sizes belong to a stretch of it.
        built: what building up proved; None where a few causes explain the record.
        cut: whether stretches of the record itself were held out.
        before: the best that commissioning errors a machine in order may have do without a cause.
    """

    found: Explanation | None
    kind: Kind
    gain: Gain | None = None
    forecast: Gain | None = None
    built: Built | None = None
    cut: bool = False
    before: Fit | None = None


def _within(found: Explanation, limit: float) -> Fit:
    """Commissioning errors alone, none beyond a limit that a rig in order does not pass [sd].

    A cause that commissioning knows too would else be in the model before, tens of sd of it, and
    naming it be worth nothing.
    """
    if found.commissioning.pull <= AT_LIMIT * limit:
        return found.commissioning
    best = found.best  # held within the limit it is a better start than what was strained
    start = np.where(best.local.runs.sd > 0.0, best.shift, 0.0)
    at = (start, best.local, 0, best.step_share)
    return refine(found.evidence, (), *at, farthest=limit, enough=ROUGH, steps=FEW)


def decide(
    desk: FitContext,
    forward: Forward,
    recordings: Sequence[Recording],
    held: HeldOut | None,
    standstill: Recording | None = None,
) -> Conclusion:
    """Explain a record, and see what the explanation is worth elsewhere.

    Args:
        desk: the record before any cause, over a threshold.
        forward: the plant, tuned to its rig where there is a baseline.
        recordings: all, fitted and held out, which a forecast is tried on; none: it is not.
        held: those held out.
        standstill: tells the noise; the declared one is taken without it.
    """
    budget, many = desk.first.evidence.runs.budget, desk.settings.causes > MANY_FROM
    budget.stage(EXPLAINED if many else BUILT)
    found = explain(desk.first, desk.thresholds, desk.settings, desk.progress, glance=many)
    budget.stage(CHOSEN if many else BUILT)
    if found is None:
        return Conclusion(None, Kind.UNKNOWN)
    if found.far:
        return Conclusion(found, Kind.UNKNOWN, before=found.commissioning)
    built, cut = None, False
    if many:
        fitted, rest = _parted(desk, held, standstill)
        begin = _begin(desk, fitted, found)
        if begin is not None or not found.adequate:
            cut, held = held is None, rest
            built = _built(desk, found, fitted, rest, begin)
    if built is not None and built.report.proved:
        return _proved(desk, forward, recordings, held, standstill, built, cut)
    if built is not None and held is not None and built.found is not found:
        gain = held.gain(built.before, built.found.best)
        if gain is not None and not gain.worse:
            return Conclusion(built.found, Kind.UNKNOWN, gain, None, built, cut, built.before)
    if cut:  # nothing is proved there, and nothing else was held out
        held = None
    if found.rough and not budget.skips("single causes and pairs weighed in full"):
        found = explain(desk.first, desk.thresholds, desk.settings, desk.progress) or found
    found = _probed(found, desk.settings)
    limit = pull_limit(desk.first.screen.bank, desk.settings.alpha)
    before = _within(found, limit)
    gains = held.gains(found, before, ALMOST) if held else []
    kind = _kind(found, gains, limit)
    ahead = _ahead(desk, forward, recordings, found, standstill) if kind.names_causes else None
    return Conclusion(found, kind, gains[0] if gains else None, ahead, built, cut, before)


def _built(
    desk: FitContext, found: Explanation, fitted: Dataset, rest: HeldOut, begin: Start | None
) -> Built | None:
    """What building up proves; None where it has nothing to offer, or was ended before."""
    try:
        return build_up(desk, found, fitted, rest.seen, begin)
    except EndedError:
        desk.first.evidence.runs.budget.leave_out(ONE_BY_ONE)
        return None


def _begin(desk: FitContext, fitted: Dataset, found: Explanation) -> Start | None:
    """A start by the measured motion, nearer than an explanation that leaves more than noise.

    A simulation may be off by a share of what a cause changes, which is radians where swings are
    out of step: one cause passed for all that a lively arm of three had.
    """
    best = found.best
    if not found.adequate:
        return inverse_start(desk, fitted, found.commissioning)
    leaves_noise = best.chi2 < MORE * len(best.residual)
    return None if leaves_noise else inverse_start(desk, fitted, best)


def _parted(
    desk: FitContext, held: HeldOut | None, standstill: Recording | None
) -> tuple[Dataset, HeldOut]:
    """What is fitted and what proves it: stretches of the record where nothing was held out."""
    evidence = desk.first.evidence
    fitted = Dataset(evidence.runs, evidence.measured, ())
    if held is not None:
        return fitted, held
    fitted, rest = split(fitted)
    return fitted, HeldOut(rest, whitening_of(rest.runs, standstill), desk.settings)


def _proved(
    desk: FitContext,
    forward: Forward,
    recordings: Sequence[Recording],
    held: HeldOut | None,
    standstill: Recording | None,
    built: Built,
    cut: bool,
) -> Conclusion:
    """Causes that were proved one by one: all of it, or a part."""
    found = built.found
    kind = Kind.PARTIAL
    if found.adequate:
        kind = Kind.NAMED if len(found.best.causes) == 1 else Kind.SEVERAL
    gain = held.gain(built.before, found.best) if held else None
    ahead = _ahead(desk, forward, recordings, found, standstill)
    return Conclusion(found, kind, gain, ahead, built, cut, built.before)


def _ahead(
    desk: FitContext,
    forward: Forward,
    recordings: Sequence[Recording],
    found: Explanation,
    standstill: Recording | None,
) -> Gain | None:
    """Gain ahead in time, where a cause's sizes belong to a stretch of it."""
    if not (recordings and any(cause.transient for cause in found.best.causes)):
        return None
    workers = desk.first.screen.bank.base.runs.workers
    return forecast(forward, recordings, found.best, desk.settings, standstill, workers)


def _probed(found: Explanation, settings: Settings) -> Explanation:
    """The chosen fits once more, with runs along what they know least of their causes.

    Within the commissioning errors that they were held to: beyond, a loud cause with the gain of a
    sensor strained a tolerance again, and nothing was named though 99.99 % of the error went.
    Where runs are cheap they are first searched once more by columns of their own, and then their
    sizes are profiled. In the end what they leave says how sure they are.
    """
    evidence, dear = found.evidence, settings.sparse
    chosen = tuple(
        refine(
            evidence,
            fit.causes,
            fit.shift,
            fit.local,
            step_share=fit.step_share,
            farthest=fit.farthest,
            probed=True,
            steps=0 if dear else ITERATIONS,
            known=fit.columns if dear else None,
        )
        for fit in found.chosen
    )
    chosen = tuple(on_line(evidence, fit) for fit in chosen)
    if not settings.sparse and not evidence.runs.budget.skips("profiles of sizes"):
        chosen = tuple(profiled(evidence, fit) for fit in chosen)
    chosen = tuple(spread(evidence, fit) for fit in chosen)
    better = {fit.causes: fit for fit in chosen}
    fits = tuple(better.get(fit.causes, fit) for fit in found.fits)
    return replace(found, chosen=chosen, fits=fits)


def _kind(found: Explanation, gains: Sequence[Gain], limit: float) -> Kind:
    """A part of the truth takes held-out error away without a commissioning error over the limit.

    What strains one may owe it the gain: with its offset left out of the library, an encoder got
    a spring for a name, of a size that could be none, and 99 % of the error went.
    """
    if not found.adequate:
        strained = found.best.pull > limit
        return Kind.PARTIAL if not strained and _beats(found, gains) else Kind.UNKNOWN
    if len(found.chosen) > 1:
        return Kind.AMBIGUOUS
    return Kind.NAMED if len(found.best.causes) == 1 else Kind.SEVERAL


def _beats(found: Explanation, gains: Sequence[Gain]) -> bool:
    """Whether the causes take most of the held-out excess away, and no rival nearly as much."""
    if len(found.chosen) > 1 or not gains or gains[0].low is None:
        return False
    return gains[0].low > max([ALMOST, *(gain.share or 0.0 for gain in gains[1:])])
