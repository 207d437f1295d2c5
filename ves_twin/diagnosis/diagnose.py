"""diagnose: from recordings to a verdict."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from time import perf_counter

from ves_twin.core.errors import UnknownNameError
from ves_twin.core.recording.recording import Recording
from ves_twin.core.workers import Workers
from ves_twin.diagnosis.assemble_verdict import Findings, assemble_verdict
from ves_twin.diagnosis.assess import assess, pull_limit
from ves_twin.diagnosis.both_views import both_views, is_firm
from ves_twin.diagnosis.decide import decide
from ves_twin.diagnosis.differential import differential
from ves_twin.diagnosis.disagreement import Alone, disagreement
from ves_twin.diagnosis.explain import explain
from ves_twin.diagnosis.explanation import Explanation
from ves_twin.diagnosis.fit_context import FitContext
from ves_twin.diagnosis.forward import Excitation, Forward
from ves_twin.diagnosis.held_out import HeldOut
from ves_twin.diagnosis.law.explained import lawful_explanation, lawful_rest
from ves_twin.diagnosis.law.own_motion import own_motion
from ves_twin.diagnosis.law.propose import Limits
from ves_twin.diagnosis.law.result import LAW
from ves_twin.diagnosis.likeness import check_likeness
from ves_twin.diagnosis.next_experiment import separations
from ves_twin.diagnosis.null import cached_thresholds
from ves_twin.diagnosis.preprocess import Dataset, preprocess
from ves_twin.diagnosis.rungs import FEWER
from ves_twin.diagnosis.runs import Progress, Runs, silent
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.signature_library import SignatureLibrary, build_bank, cached_bank
from ves_twin.diagnosis.tolerances import cached_scale, check_commissioned, naming_limit
from ves_twin.diagnosis.verdict import Basis, Kind, Proposal, Verdict
from ves_twin.diagnosis.whitening import Whitening, whitening_of
from ves_twin.diagnosis.widened import Widened, widening

DEAR = 0.1
"""Share of the minutes from which a bank is built with fewer runs: on a measured machine what
single causes do is the lesser part of the work (a platform: 270 s of 720 for a bank)."""


def diagnose(
    forward: Forward,
    recordings: Sequence[Recording],
    *,
    held_out: Sequence[Recording] = (),
    commissioning: Sequence[Recording] = (),
    standstill: Recording | None = None,
    baseline: Sequence[Recording] = (),
    next_programmes: Sequence[Excitation] | Callable[[], Sequence[Excitation]] = (),
    exclude: Sequence[str] = (),
    settings: Settings | None = None,
    progress: Progress = silent,
) -> Verdict:
    """Name what a plant's simulation gets wrong, or say that nothing is, or that it is not known.

    Residuals in units of noise, with commissioning tolerances marginalised; a bank of finite
    signatures ranks the causes, the full forward fits the best of them, what is left must be noise.

    Args:
        forward: the plant, its tolerances and its library of causes.
        recordings: what was measured; all of them together are one record.
        held_out: other recordings, on which the gain of an extension is measured.
        commissioning: of independent rigs in order, or of re-mountings of this one; five or more
            tell how true the declared tolerances are.
        standstill: tells the noise; the declared one is taken without it.
        baseline: of this rig in order, of the same programmes: what the model always gets wrong
            on it is taken off, so that only what has changed since is named.
        next_programmes: candidates for the next experiment where causes cannot be told apart; or
            what makes them, called only then.
        exclude: causes that are not considered, by effect or effect@target.
        settings: how sure, how many.
        progress: told what is being done.

    Raises:
        InvalidInputError: recordings that cannot be compared, columns that look swapped, turned
            or in other units, or too few rigs in order to tell the tolerances.
        UnknownNameError: a signal that is not recorded, or an unknown cause in `exclude`.
    """
    chosen = settings or Settings()
    _check_causes(forward, exclude)
    check_commissioned(len(commissioning))
    with Workers(chosen.workers, chosen.budget) as workers:
        scale = _scale(forward, commissioning, workers, chosen)
        material = _Material(
            tuple(recordings),
            tuple(held_out),
            standstill,
            tuple(baseline),
            next_programmes,
            tuple(exclude),
            scale,
        )
        declared = _View.of(forward, material, chosen, workers, progress)
        wide = widening(scale)
        if wide == 1.0 or not declared.loud:
            return declared.verdict(progress)
        widened = Widened(forward, wide)
        measured = _View.of(widened, material, chosen, workers, progress, wide).verdict(progress)
        if is_firm(measured):
            return measured
        in_order = measured.verdict is Kind.NOTHING
        return both_views(declared.verdict(progress, alone=in_order), measured)


@dataclass(frozen=True)
class _Material:
    """What a verdict is taken from, whatever the tolerances."""

    recordings: tuple[Recording, ...]
    held_out: tuple[Recording, ...]
    standstill: Recording | None
    baseline: tuple[Recording, ...]
    next_programmes: Sequence[Excitation] | Callable[[], Sequence[Excitation]]
    exclude: tuple[str, ...]
    scale: float | None


@dataclass(frozen=True)
class _View:
    """A record with the tolerances of one forward, looked at and not explained.

    Attributes:
        forward: the plant.
        material: the record and what is beside it.
        findings: with the record before any cause.
        pull: commissioning error that a rig in order does not pass [sd].
        whitening: noise as declared or measured.
    """

    forward: Forward
    material: _Material
    findings: Findings
    pull: float
    whitening: Whitening

    @staticmethod
    def of(
        forward: Forward,
        material: _Material,
        chosen: Settings,
        workers: Workers,
        progress: Progress,
        widened: float = 1.0,
    ) -> _View:
        """Look; the forward's tolerances are `widened` times the declared ones."""
        recordings, standstill = material.recordings, material.standstill
        progress(0.0, "the model as it was given")
        seen = preprocess(forward, recordings, workers, chosen.rate)
        whitening = whitening_of(seen.runs, standstill)
        differs = None
        if material.baseline:
            usual = material.baseline
            seen, whitening, differs = _changed(
                seen, whitening, recordings, usual, standstill, chosen
            )
        bank = _bank(seen, chosen, progress).without(material.exclude)
        limits = cached_thresholds(bank, whitening, chosen, progress)
        pull = pull_limit(bank, chosen.alpha)
        levels = (limits.effect, limits.misfit, pull, limits.bends, chosen.sparse)
        first = assess(seen.measured, bank, whitening, *levels, progress=progress)
        kappa, scale = naming_limit(bank, material.scale), material.scale
        logged = any(one.info.imported for one in recordings)
        findings = Findings(seen, first, limits, chosen, kappa, scale, logged, widened, differs)
        return _View(forward, material, findings, pull, whitening)

    @property
    def loud(self) -> bool:
        """Whether something is there."""
        limits = self.findings.limits
        return self.findings.first.exceeds(limits.effect, limits.misfit, self.pull)

    @property
    def limits(self) -> Limits:
        """Of a claim."""
        misfit = self.findings.limits.misfit
        return Limits(misfit, self.pull, self.findings.settings.model_error)

    def verdict(self, progress: Progress, alone: bool = False) -> Verdict:
        """Explain it; `alone` asks for a single cause that leaves noise, and for nothing else."""
        findings, material = self.findings, self.material
        seen, chosen, first = findings.seen, findings.settings, findings.first
        basis = replace(_basis(material), baseline_differs=findings.differs)
        if not self.loud:
            return assemble_verdict(findings, Kind.NOTHING, basis, material.exclude)
        desk = FitContext(first, findings.limits, chosen, progress)
        if alone and not _one_is_enough(desk):
            return assemble_verdict(findings, Kind.UNKNOWN, basis, material.exclude)
        held_out, still, workers = material.held_out, material.standstill, seen.runs.workers
        own = seen.runs.forward  # tuned to this rig where there is a baseline
        held = HeldOut.of(own, held_out, still, chosen, workers) if held_out else None
        end = decide(desk, own, (*material.recordings, *held_out), held, still)
        found, kind = end.found, end.kind
        ambiguous = kind is Kind.AMBIGUOUS
        proposals = _next(seen.runs, found, material.next_programmes) if ambiguous else ()
        apart: tuple[Alone, ...] = ()
        proved = end.built is not None and bool(end.built.report.proved)
        seen.runs.budget.stage(1.0)
        if not (proved or (found is not None and found.adequate)):
            bank, limits = first.screen.bank, findings.limits
            apart = disagreement(seen, bank, self.whitening, limits, chosen, progress)
        if end.cut:
            basis = replace(basis, held_out="split")
        lawful, unknown = None, kind is Kind.UNKNOWN
        seen.runs.budget.stage(math.inf if chosen.laws else 1.0)  # asked for, whatever it takes
        looks = not chosen.sparse if chosen.laws is None else chosen.laws  # dear runs: if asked
        wanted = looks and (unknown or (kind is Kind.PARTIAL and proved))
        if wanted and not seen.runs.budget.skips(LAW):
            progress(0.0, "looking for a law" if unknown else "looking for a law in what is left")
            if end.built is not None and not unknown:
                lawful = lawful_rest(end.built, self.limits, chosen, still, progress)
            else:
                lawful = lawful_explanation(first, found, self.limits, chosen, held, progress)
        basis = replace(basis, left_out=tuple(seen.runs.budget.left_out))
        report = end.built.report if end.built else None
        if end.built is not None and proved:
            report = own_motion(end.built, progress)
        findings = replace(
            findings,
            law=lawful.finding if lawful else None,
            shown=lawful.explanation if lawful and unknown else None,
            beside=lawful.explanation if lawful and not unknown else None,
            found=found,
            built=report,
            gain=lawful.gain if lawful and lawful.explanation and unknown else end.gain,
            forecast=end.forecast,
            before=end.before,
            proposals=proposals,
            apart=apart,
        )
        return assemble_verdict(findings, kind, basis, material.exclude)


def _one_is_enough(desk: FitContext) -> bool:
    """Whether a single cause leaves noise."""
    found = explain(desk.first, desk.thresholds, desk.settings, desk.progress, together=False)
    return found is not None and found.adequate


def _changed(
    seen: Dataset,
    whitening: Whitening,
    recordings: Sequence[Recording],
    baseline: Sequence[Recording],
    standstill: Recording | None,
    settings: Settings,
) -> tuple[Dataset, Whitening, float]:
    """The record about the rig as its baseline shows it, its noise, what the inputs differ by."""

    def again(tuned: Forward) -> Dataset:
        return preprocess(tuned, recordings, seen.runs.workers, settings.rate)

    changed = differential(seen, baseline, again, whitening)
    own = whitening_of(changed.seen.runs, standstill)
    return changed.seen, replace(own, level=own.level * changed.noise), changed.differs


def _bank(seen: Dataset, settings: Settings, progress: Progress) -> SignatureLibrary:
    runs = seen.runs
    fewer = settings.sparse or _is_dear(runs, settings)
    if fewer and not settings.sparse:
        runs.budget.leave_out(FEWER)

    def build() -> SignatureLibrary:
        check_likeness(seen, runs.one(runs.origin))  # before minutes of simulation
        return build_bank(runs, progress=progress, sparse=fewer)

    bank = cached_bank(runs, settings.cache, build, "sparse" if fewer else "")
    check_likeness(seen, bank.base.prediction)
    return bank


def _is_dear(runs: Runs, settings: Settings) -> bool:
    """Whether all sizes of all causes would take DEAR of the time."""
    sizes = sum(len(hypothesis.departures()) for hypothesis in runs.forward.hypotheses)
    begun = perf_counter()
    runs.one(runs.origin)
    once = perf_counter() - begun
    return sizes * once > DEAR * 60.0 * settings.minutes * settings.workers


def _check_causes(forward: Forward, names: Sequence[str]) -> None:
    known = {h.effect for h in forward.hypotheses} | {h.label for h in forward.hypotheses}
    for name in names:
        if name not in known:
            raise UnknownNameError("cause", name, known)


def _basis(material: _Material) -> Basis:
    return Basis(
        noise="declared" if material.standstill is None else "measured",
        tolerances="declared" if material.scale is None else "measured",
        held_out="measured" if material.held_out else "none",
        baseline="measured" if material.baseline else "none",
    )


def _scale(
    forward: Forward, commissioning: Sequence[Recording], workers: Workers, chosen: Settings
) -> float | None:
    if not commissioning:
        return None
    rigs = [preprocess(forward, [recording], workers, chosen.rate) for recording in commissioning]
    return cached_scale([(rig.runs, rig.measured) for rig in rigs], chosen.cache)


def _next(
    runs: Runs,
    found: Explanation | None,
    programmes: Sequence[Excitation] | Callable[[], Sequence[Excitation]],
) -> tuple[Proposal, ...]:
    if found is None:
        return ()
    offered = programmes() if callable(programmes) else programmes
    ranked = separations(runs, found.chosen, offered)
    return tuple(Proposal(s.programme.name, s.chi2) for s in ranked)
