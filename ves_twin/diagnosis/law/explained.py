"""lawful_explanation: a law for a record that no cause explains, where one may be looked for."""

from __future__ import annotations

from dataclasses import dataclass, replace
from time import perf_counter

from ves_twin.diagnosis.assess import Assessment
from ves_twin.diagnosis.evidence import Evidence
from ves_twin.diagnosis.explanation import Explanation
from ves_twin.diagnosis.gain import Gain
from ves_twin.diagnosis.law.finding import law_finding
from ves_twin.diagnosis.law.place import LawForward
from ves_twin.diagnosis.law.propose import Limits, Search, search_laws
from ves_twin.diagnosis.law.result import LawFinding
from ves_twin.diagnosis.law.screen import runs_of
from ves_twin.diagnosis.preprocess import Dataset
from ves_twin.diagnosis.refine import Fit
from ves_twin.diagnosis.runs import Progress
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.whitening import Whitening

LONGEST = 300.0
"""Time [s] that a search nobody asked for may take."""


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
    held: tuple[Dataset, Whitening] | None,
    progress: Progress,
) -> Lawful | None:
    """Look for a law.

    Args:
        first: the record before any cause.
        found: the best of the library, which is not good enough; None if it has nothing.
        limits: of a claim.
        settings: whether laws are wanted, and how sure.
        held: held-out recordings and their noise.
        progress: told how far it is.

    Returns:
        None where nobody asked, or the plant has no places for laws.
    """
    runs = first.evidence.runs
    plant, commissioning = runs.forward, found.commissioning if found else first.commissioning
    if settings.laws is False or commissioning is None or not isinstance(plant, LawForward):
        return None
    if any(programme.poses for programme in runs.programmes) or not plant.law_places():
        return None
    begin = perf_counter()
    runs.one(commissioning.shift)
    once = (perf_counter() - begin) / runs.workers.count
    if settings.laws is None and runs_of(plant.law_places()) * once > LONGEST:
        return None
    evidence = found.evidence if found else first.evidence
    search = search_laws(evidence, commissioning, limits, progress)
    if search is None:
        return None
    finding = law_finding(search, settings, held)
    if not finding.claimed or found is None:
        return Lawful(finding, None)
    return Lawful(finding, _explained(found, search))


def _explained(found: Explanation, search: Search) -> Explanation:
    """The law in place of the library's best."""
    fit: Fit = search.best.fit
    evidence: Evidence = search.evidence
    return replace(
        found, evidence=evidence, commissioning=search.none.fit, chosen=(fit,), weights=(1.0,)
    )
