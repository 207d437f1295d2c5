"""View: a record with the tolerances of one forward, looked at and not explained."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from time import perf_counter

from ves_twin.core.recording.recording import Recording
from ves_twin.core.workers import Workers
from ves_twin.diagnosis.bank.rungs import FEWER
from ves_twin.diagnosis.bank.signature_library import SignatureLibrary, build_bank, cached_bank
from ves_twin.diagnosis.fit.assess import pull_limit
from ves_twin.diagnosis.fit.differential import differential
from ves_twin.diagnosis.fit.looked import looked
from ves_twin.diagnosis.fit.tolerances import naming_limit
from ves_twin.diagnosis.law.propose import Limits
from ves_twin.diagnosis.model.forward import Excitation, Forward
from ves_twin.diagnosis.record.by_motion import by_motion
from ves_twin.diagnosis.record.likeness import check_likeness
from ves_twin.diagnosis.record.preprocess import Dataset, preprocess
from ves_twin.diagnosis.record.repeated import moved_alike, repeated
from ves_twin.diagnosis.record.runs import Progress, Runs
from ves_twin.diagnosis.record.whitening import Whitening, whitening_of
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.unseen.held_out import HeldOut
from ves_twin.diagnosis.verdict.assemble_verdict import Findings
from ves_twin.diagnosis.verdict.verdict import Basis

DEAR = 0.1
"""Share of the minutes from which a bank is built with fewer runs: on a measured machine what
single causes do is the lesser part of the work (a platform: 270 s of 720 for a bank)."""

LOOKED = 0.25
"""Share of the time after which commissioning errors are not searched on before any cause: 33
pieces of a floating robot, each with a start of its own, took all of six minutes for them."""


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
        workers.budget.tells = True
        workers.budget.stage(LOOKED)
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
    def basis(self) -> Basis:
        """What a verdict on it stands on."""
        material = self.material
        return Basis(
            noise="declared" if material.standstill is None else "measured",
            tolerances="declared" if material.scale is None else "measured",
            held_out="measured" if material.held_out else "none",
            baseline="measured" if material.baseline else "none",
            baseline_differs=self.findings.differs,
            by_motion=self.moved,
            held_out_repeats=self._repeats,
        )

    @property
    def _repeats(self) -> bool:
        """Whether what is held out was fed in, or moved, as what is fitted."""
        held, fitted = self.material.held_out, self.material.recordings
        fed = tuple(self.forward.drive)
        seen = tuple(dict.fromkeys(one.signal for one in self.forward.channels))
        return repeated(_told(held, fed), _told(fitted, fed)) or moved_alike(
            _told(held, seen), _told(fitted, seen)
        )

    @property
    def limits(self) -> Limits:
        """Of a claim."""
        misfit = self.findings.limits.misfit
        return Limits(misfit, self.pull, self.findings.settings.model_error)

    @property
    def out_of_step(self) -> bool:
        """Whether simulations cannot follow it, and no baseline says how the rig moves in order."""
        return self.findings.limits.in_order is not None and not self.material.baseline

    def seen_by_motion(self, progress: Progress) -> View | None:
        """The record by efforts that its motion lacks; None where simulations can follow it.

        None, too, where a baseline is given, or the motion is not measured.
        """
        findings, material = self.findings, self.material
        if not self.out_of_step:
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

    @property
    def standstill(self) -> Recording | None:
        """That tells the noise; of efforts that a motion lacks it tells none."""
        return None if self.moved else self.material.standstill

    def held(self) -> HeldOut | None:
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


def _told(recordings: Sequence[Recording], names: Sequence[str]) -> list[Excitation]:
    """Those of some signals that recordings have."""
    return [Excitation.of(one, tuple(n for n in names if n in one.signals)) for one in recordings]


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
