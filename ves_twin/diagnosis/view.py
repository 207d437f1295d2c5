"""View: a record with the tolerances of one forward: looked at, explained, told."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from time import perf_counter

from ves_twin.core.recording.recording import Recording
from ves_twin.core.workers import Workers
from ves_twin.diagnosis.assemble_verdict import Findings, assemble_verdict
from ves_twin.diagnosis.assess import pull_limit
from ves_twin.diagnosis.by_motion import by_motion
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
from ves_twin.diagnosis.looked import looked
from ves_twin.diagnosis.next_experiment import separations
from ves_twin.diagnosis.preprocess import Dataset, preprocess
from ves_twin.diagnosis.rungs import FEWER
from ves_twin.diagnosis.runs import Progress, Runs
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.signature_library import SignatureLibrary, build_bank, cached_bank
from ves_twin.diagnosis.tolerances import naming_limit
from ves_twin.diagnosis.verdict import Basis, Kind, Proposal, Verdict
from ves_twin.diagnosis.whitening import Whitening, whitening_of

DEAR = 0.1
"""Share of the minutes from which a bank is built with fewer runs: on a measured machine what
single causes do is the lesser part of the work (a platform: 270 s of 720 for a bank)."""


@dataclass(frozen=True)
class Material:
    """What a verdict is taken from, whatever the tolerances."""

    recordings: tuple[Recording, ...]
    held_out: tuple[Recording, ...]
    standstill: Recording | None
    baseline: tuple[Recording, ...]
    next_programmes: Sequence[Excitation] | Callable[[], Sequence[Excitation]]
    exclude: tuple[str, ...]
    scale: float | None


@dataclass(frozen=True)
class View:
    """A record with the tolerances of one forward, looked at and not explained.

    Attributes:
        forward: the plant.
        material: the record and what is beside it.
        findings: with the record before any cause.
        pull: commissioning error that a rig in order does not pass [sd].
        whitening: noise as declared or measured.
        moved: whether efforts that the motion lacks are compared, and no simulation.
    """

    forward: Forward
    material: Material
    findings: Findings
    pull: float
    whitening: Whitening
    moved: bool = False

    @staticmethod
    def of(
        forward: Forward,
        material: Material,
        chosen: Settings,
        workers: Workers,
        progress: Progress,
        widened: float = 1.0,
    ) -> View:
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
        limits, first = looked(seen.measured, bank, whitening, chosen, progress)
        kappa, scale = naming_limit(bank, material.scale), material.scale
        logged = any(one.info.imported for one in recordings)
        findings = Findings(seen, first, limits, chosen, kappa, scale, logged, widened, differs)
        pull = pull_limit(bank, chosen.alpha)
        return View(forward, material, findings, pull, whitening)

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

    def seen_by_motion(self, progress: Progress) -> View | None:
        """The record by efforts that its motion lacks; None where simulations can follow it.

        None, too, where a baseline is given, or the motion is not measured.
        """
        findings, material = self.findings, self.material
        if findings.limits.in_order is None or material.baseline:
            return None
        seen, chosen = by_motion(findings.seen, True, noisy=True), findings.settings
        if seen is None:
            return None
        progress(0.0, "what the measured motion lacks")
        whitening = whitening_of(seen.runs, None)
        bank = _bank(seen, chosen, progress).without(material.exclude)
        limits, first = looked(seen.measured, bank, whitening, chosen, progress)
        limits = replace(limits, in_order=findings.limits.in_order)
        findings = replace(findings, seen=seen, first=first, limits=limits)
        return replace(self, findings=findings, whitening=whitening, moved=True)

    def _held(self) -> HeldOut | None:
        """Held-out recordings, seen as the others are."""
        material, seen = self.material, self.findings.seen
        if not material.held_out:
            return None
        own = self.forward if self.moved else seen.runs.forward  # a baseline tunes it to its rig
        still, chosen = material.standstill, self.findings.settings
        held = HeldOut.of(own, material.held_out, still, chosen, seen.runs.workers)
        if not self.moved:
            return held
        moved = by_motion(held.seen, True, noisy=True)
        return HeldOut(moved, whitening_of(moved.runs, None), chosen) if moved else None

    def told(self, progress: Progress, alone: bool = False) -> Verdict:
        """The verdict by simulations; by the motion, where they fall out of step and do not tell.

        By the motion first: it takes seconds, and simulations may use up the time.
        """
        moved = self.seen_by_motion(progress)
        by_motion = moved.verdict(progress) if moved else None
        if by_motion is None or not by_motion.proved:
            return self.verdict(progress, alone)
        findings = self.findings
        lawless = replace(findings, settings=replace(findings.settings, laws=False))
        found = replace(self, findings=lawless).verdict(progress, alone)
        return by_motion if found.lacks else found

    def verdict(self, progress: Progress, alone: bool = False) -> Verdict:
        """Explain it; `alone` asks for a single cause that leaves noise, and for nothing else."""
        findings, material = self.findings, self.material
        seen, chosen, first = findings.seen, findings.settings, findings.first
        basis = replace(_basis(material), baseline_differs=findings.differs, by_motion=self.moved)
        if not self.loud:
            return assemble_verdict(findings, Kind.NOTHING, basis, material.exclude)
        desk = FitContext(first, findings.limits, chosen, progress)
        if alone and not _one_is_enough(desk):
            return assemble_verdict(findings, Kind.UNKNOWN, basis, material.exclude)
        still = None if self.moved else material.standstill
        every = () if self.moved else (*material.recordings, *material.held_out)
        held = self._held()
        end = decide(desk, seen.runs.forward, every, held, still)
        found, kind = end.found, end.kind
        ambiguous = kind is Kind.AMBIGUOUS
        asks = ambiguous and not self.moved
        proposals = _next(seen.runs, found, material.next_programmes) if asks else ()
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
        wanted = looks and not self.moved and (unknown or (kind is Kind.PARTIAL and proved))
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


def _basis(material: Material) -> Basis:
    return Basis(
        noise="declared" if material.standstill is None else "measured",
        tolerances="declared" if material.scale is None else "measured",
        held_out="measured" if material.held_out else "none",
        baseline="measured" if material.baseline else "none",
    )


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
