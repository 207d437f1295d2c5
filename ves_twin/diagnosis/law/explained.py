"""lawful_explanation, lawful_rest: laws where no cause explains a record, or proved ones a part."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from time import perf_counter

from ves_twin.core.recording.recording import Recording
from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.build_up.build_up import Built
from ves_twin.diagnosis.fit.assess import Assessment
from ves_twin.diagnosis.fit.explanation import Explanation
from ves_twin.diagnosis.fit.refine import Fit
from ves_twin.diagnosis.law.finding import law_finding
from ves_twin.diagnosis.law.lean import LeanEvidence
from ves_twin.diagnosis.law.propose import Limits, Search, search_laws
from ves_twin.diagnosis.law.rest import search_rest
from ves_twin.diagnosis.law.result import LAW, LawFinding
from ves_twin.diagnosis.law.screen import runs_of
from ves_twin.diagnosis.model.law_forward import LawForward
from ves_twin.diagnosis.record.evidence import Evidence
from ves_twin.diagnosis.record.runs import Progress, Runs
from ves_twin.diagnosis.record.whitening import whitening_of
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.unseen.gain import Gain
from ves_twin.diagnosis.unseen.held_out import HeldOut

LONGEST = 300.0
"""Time [s] that a search nobody asked for may take."""

RETRIED = 3
"""Laws near the chosen one that held-out recordings are asked about where they refuse that."""


NEAR = 0.999
"""Share of commissioning errors at which a run is timed."""


@dataclass(frozen=True)
class Lawful:
    """What a search found, and, where it is claimed, the record as the law explains it."""

    finding: LawFinding
    explanation: Explanation | None

    @property
    def gain(self) -> Gain | None:
        """Of the law on held-out recordings."""
        return self.finding.gain


def lawful_explanation(
    first: Assessment,
    found: Explanation | None,
    limits: Limits,
    settings: Settings,
    held: HeldOut | None,
    progress: Progress,
) -> Lawful | None:
    """Look for a law.

    Args:
        first: the record before any cause.
        found: the best of the library, which is not good enough; None if it has nothing.
        limits: of a claim.
        settings: whether laws are wanted, and how sure.
        held: held-out recordings.
        progress: told how far it is.

    Returns:
        None where nobody asked, or the plant has no places for laws.
    """
    commissioning = found.commissioning if found else first.commissioning
    if commissioning is None or not _asked(first.evidence.runs, commissioning.shift, settings):
        return None
    evidence = found.evidence if found else first.evidence
    if settings.sparse:
        evidence = LeanEvidence(evidence.runs, evidence.measured, evidence.whitening)
    search = search_laws(evidence, commissioning, limits, progress)
    if search is None:
        return None
    search, finding = _borne_out(search, held, progress)
    if not finding.claimed or found is None:
        return Lawful(finding, None)
    return Lawful(finding, _explained(found, search))


def lawful_rest(
    built: Built,
    limits: Limits,
    settings: Settings,
    standstill: Recording | None,
    progress: Progress,
) -> Lawful | None:
    """Look for a law in what proved causes leave.

    Args:
        built: the causes.
        limits: of a claim.
        settings: whether laws are wanted, and how sure.
        standstill: tells the noise; the declared one is taken without it.
        progress: told how far it is.

    Returns:
        None where nobody asked, or the plant has no places for laws.
    """
    causes, held = built.found.best, built.held
    if not _asked(built.fitted.runs, causes.shift, settings):
        return None
    rest = search_rest(built.fitted, causes, limits, progress)
    if rest is None:
        return None
    whitening = whitening_of(held.runs, standstill)
    gain = HeldOut(held, whitening, settings).gain(built.before, causes)
    alone = {name: after for name, (_, after) in gain.errors.items()} if gain else None
    there = replace(held, runs=replace(held.runs, forward=rest.evidence.runs.forward))
    tried = HeldOut(there, replace(whitening, runs=there.runs), settings)
    search, finding = _borne_out(rest, tried, progress, alone)
    finding = replace(finding, part=True, gain=_over(finding.gain, alone))
    if not finding.claimed:
        return Lawful(finding, None)
    return Lawful(finding, _explained(built.found, search))


def _over(gain: Gain | None, alone: Mapping[str, float] | None) -> Gain | None:
    """A law's gain with errors over what the causes were proved to leave: tuning is another's."""
    if gain is None or not alone:
        return gain
    errors = {n: (alone[n], after) for n, (_, after) in gain.errors.items()}
    return replace(gain, errors=errors, given={})


def _borne_out(
    search: Search,
    held: HeldOut | None,
    progress: Progress,
    causes: Mapping[str, float] | None = None,
) -> tuple[Search, LawFinding]:
    """The chosen law; one near it, where held-out recordings bear that one out and not this one.

    A motion that goes on beyond the range that was fitted tells a sine from a polynomial.
    """
    first = law_finding(search, held, progress, causes)
    if first.claimed or search.reason:
        return search, first
    for other in search.rivals[:RETRIED]:
        finding = law_finding(other, held, progress, causes)
        if finding.claimed:
            return other, finding
    return search, first


def _asked(runs: Runs, shift: FloatArray, settings: Settings) -> bool:
    """Whether laws are wanted, can act, and are found in time."""
    plant = runs.forward
    if settings.laws is False or not isinstance(plant, LawForward):
        return False
    if any(programme.poses for programme in runs.programmes) or not plant.law_places():
        return False
    begin = perf_counter()
    runs.one(runs.depart(shift, runs.nuisances, NEAR * shift[runs.nuisances]))  # else it is kept
    once = (perf_counter() - begin) / runs.workers.count
    takes = runs_of(plant.law_places(), settings.sparse) * once
    if settings.laws is None and takes > LONGEST:
        runs.budget.leave_out(f"{LAW} (some {takes / 60.0:.0f} min: --law asks for it)")
        return False
    return True


def _explained(found: Explanation, search: Search) -> Explanation:
    """The law in place of the library's best."""
    fit: Fit = search.best.fit
    evidence: Evidence = search.evidence
    return replace(
        found, evidence=evidence, commissioning=search.none.fit, chosen=(fit,), weights=(1.0,)
    )
