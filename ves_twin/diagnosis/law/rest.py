"""search_rest: laws of what proved causes leave, against model error as the record shows it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.bank.linearise import FORWARD_STEP, linearise
from ves_twin.diagnosis.build_up.discrepancy import discrepancy
from ves_twin.diagnosis.fit.refine import Fit, bare_residual
from ves_twin.diagnosis.law.beside import Beside
from ves_twin.diagnosis.law.candidate import Candidate, Table
from ves_twin.diagnosis.law.closed import closed_forms
from ves_twin.diagnosis.law.fit_law import LawFit, fit_law
from ves_twin.diagnosis.law.propose import CLAIM, LEADERS, WORTH, Limits, Search
from ves_twin.diagnosis.law.rest_screen import rest_screen
from ves_twin.diagnosis.law.rubbing import rubbings
from ves_twin.diagnosis.law.screen import ranges, smooth_candidates
from ves_twin.diagnosis.model.law_forward import LawForward
from ves_twin.diagnosis.record.evidence import Evidence
from ves_twin.diagnosis.record.preprocess import Dataset
from ves_twin.diagnosis.record.runs import Progress, Runs, silent
from ves_twin.diagnosis.record.whitening import Whitening

EQUAL = 3.0
"""Nats within which a law with fewer numbers is as good: odds below 20."""


STRAIN = 1.0
"""Commissioning sd that a law may need beyond what the causes need without it."""


@dataclass(frozen=True)
class RestSearch(Search):
    """Laws of a rest that is model error for the most part: what a law leaves need not be noise."""

    @property
    def reason(self) -> str:
        """Why the best law is not claimed; empty where it may be."""
        if self.best.fit.pull >= self.limits.pull:
            return f"it needs a commissioning error of {self.best.fit.pull:.1f} sd"
        return ""


def search_rest(
    fitted: Dataset, causes: Fit, limits: Limits, progress: Progress = silent
) -> RestSearch | None:
    """Fit laws beside causes that were proved, sizes of the causes and tolerances free.

    Places and variables are ranked by plain squares: whitened in time by a rest that is a law of
    the motion, that law would be taken for noise. Odds are against model error as in `build_up`, as
    the best law leaves it. A law of time is none of a
    machine: whatever is left is some function of time.

    Args:
        fitted: recordings that the causes were fitted to.
        causes: that fit; its plant is a `LawForward`.
        limits: of a claim.
        progress: told how far it is.

    Returns:
        None where no place has a variable that moves, or no law stands out from model error.
    """
    plant = causes.local.runs.forward
    if not isinstance(plant, LawForward):
        raise TypeError(f"{type(plant).__name__} has no places for laws")
    beside = Beside.to(causes, plant)
    runs = replace(fitted.runs, forward=beside)
    begin = _begin(causes, runs)
    left = np.asarray(fitted.measured - causes.prediction, float)
    first = Evidence(runs, fitted.measured, _plain(runs, left))
    none = fit_law(first, None, begin)
    limits = replace(limits, pull=max(limits.pull, none.fit.pull + STRAIN))
    ends = ranges(beside, none)
    smooth = _smooth(plant, ends)
    if not smooth:
        return None
    leaders = rest_screen(first, smooth, none, progress)[:LEADERS]
    found = []
    for n, leader in enumerate(leaders):
        progress(n / len(leaders), "fitting laws of what is left")
        found.append(fit_law(first, leader, none.fit))
    rest = np.asarray(bare_residual(first, found[0].fit), float)
    second = replace(first, whitening=discrepancy(runs, rest))
    none = fit_law(second, None, none.fit)
    found = [fit_law(second, one.candidate, one.fit, one.numbers) for one in found]
    best = _first(found)[0]
    if best.log_evidence > none.log_evidence + WORTH:
        found += closed_forms(second, best, ends, progress)
    ranked = _first(found)
    near = [one for one in ranked if one.log_evidence > ranked[0].log_evidence - EQUAL]
    chosen = min(near, key=lambda one: (one.count, -one.log_evidence))
    pool = (chosen, *(one for one in ranked if one is not chosen))
    search = RestSearch(second, none, pool, 0.0, limits)
    return search if search.nats > CLAIM else None


def _smooth(plant: LawForward, ends: Mapping[str, tuple[float, float]]) -> list[Candidate]:
    """Tables of what is no time, and frictions that depend on where a joint stands."""
    places = plant.law_places()
    tables = [c for c in smooth_candidates(places, ends) if isinstance(c, Table)]
    return [*(c for c in tables if c.of[0].what != "time"), *rubbings(places, ends)]


def _begin(causes: Fit, runs: Runs) -> Fit:
    """The fit as a start of those beside its causes, from which departures count then."""
    shift = causes.shift.copy()
    for cause in causes.causes:
        shift[causes.local.runs.indices(cause)] = 0.0
    return replace(causes, shift=shift, local=linearise(runs, shift, forward_step=FORWARD_STEP))


def _plain(runs: Runs, left: FloatArray) -> Whitening:
    """Each channel by itself in units of what is left there.

    What goes along in two channels is what a law of two joints would be, and no error to mix out.
    """
    found = discrepancy(runs, left, memory=False)
    spread = np.linalg.inv(found.mixing[0].T @ found.mixing[0])
    own = np.diag(1.0 / np.sqrt(np.diag(spread)))
    return replace(found, mixing=np.tile(own, (len(found.mixing), 1, 1)))


def _first(fits: Sequence[LawFit]) -> list[LawFit]:
    """By falling evidence; what failed is left out."""
    sound = [fit for fit in fits if np.isfinite(fit.log_evidence)]
    return sorted(sound, key=lambda fit: -fit.log_evidence)
