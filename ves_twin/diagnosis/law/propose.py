"""propose_law: from a record that no cause explains to a law, with its claim under control."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ves_twin.diagnosis.fit.refine import Fit
from ves_twin.diagnosis.law.adapted import adapted
from ves_twin.diagnosis.law.candidate import Candidate, Mesh, Table
from ves_twin.diagnosis.law.closed import closed_forms
from ves_twin.diagnosis.law.fit_law import LawFit, fit_law
from ves_twin.diagnosis.law.lean import LeanEvidence
from ves_twin.diagnosis.law.loud import loud_screen
from ves_twin.diagnosis.law.memories import memory_laws, stop_laws
from ves_twin.diagnosis.law.screen import (
    Suspect,
    both,
    knots,
    law_screen,
    ranges,
    smooth_candidates,
)
from ves_twin.diagnosis.law.tones import tone_laws
from ves_twin.diagnosis.model.law_forward import LawForward, LawPlace
from ves_twin.diagnosis.record.adequacy import cells, misfit
from ves_twin.diagnosis.record.evidence import Evidence
from ves_twin.diagnosis.record.runs import Progress, silent
from ves_twin.effects.law import LawKind

LEADERS = 4
"""Tables that are fitted: in trials the true place was among the first two of the screen in 30 of
30, and of a stop among the first five."""

NEAR = 30.0
"""Nats behind the first within which further ones are fitted, or tried on held-out recordings."""

MOST = 7
"""Tables that are fitted at most."""

LOUDEST = 2
"""Tables of a loud record that are fitted from what inverse dynamics says of them."""

BEGUN = 3
"""Linearisations before tables that are far behind are left as they are."""

WORTH = 3.0
"""Nats over no law from which a table is worth closed forms."""

FINEST = 60
"""Knots from which a table is not made finer: a ripple of 20 periods has three in each then."""

KEPT = 6
"""Laws that are fitted once more with the noise that the best leaves."""

CLAIM = 10.0
"""Nats over no law that a claim asks for, and that no further law beside it may reach."""


@dataclass(frozen=True)
class Limits:
    """What noise and commissioning errors alone do, and what the simulation may be off.

    Attributes:
        misfit: largest cell score of a rig in order.
        pull: commissioning sd of a rig in order.
        model_error: relative error of what a law changes.
    """

    misfit: float
    pull: float
    model_error: float


@dataclass(frozen=True)
class Search:
    """What was fitted, with the noise that the best leaves.

    Attributes:
        evidence: with that noise.
        none: commissioning errors alone.
        pool: laws by falling evidence, the chosen one first.
        further: nats of a further law beside the chosen one.
        limits: what was asked for.
    """

    evidence: Evidence
    none: LawFit
    pool: tuple[LawFit, ...]
    further: float
    limits: Limits

    @property
    def best(self) -> LawFit:
        """The chosen law."""
        return self.pool[0]

    @property
    def rivals(self) -> tuple[Search, ...]:
        """The search led by each law near the chosen one, the likeliest first."""
        lead = self.best.log_evidence - NEAR
        near = [fit for fit in self.pool[1:] if fit.log_evidence > lead]
        others = [tuple(x for x in self.pool if x is not fit) for fit in near]
        return tuple(
            replace(self, pool=(fit, *rest)) for fit, rest in zip(near, others, strict=True)
        )

    @property
    def nats(self) -> float:
        """Of the best over no law."""
        return self.best.log_evidence - self.none.log_evidence

    def allowance(self, fit: LawFit) -> float:
        """Nats that the simulation's error may make."""
        fall = max(self.none.fit.chi2 - fit.fit.chi2, 0.0)
        return 0.5 * self.limits.model_error**2 * fall

    def score(self, fit: LawFit) -> float:
        """Largest cell score that a law leaves."""
        own = self.evidence.whitening
        before, after = cells(own, self.none.fit.residual), cells(own, fit.fit.residual)
        return misfit(after, before, self.limits.model_error)

    def leaves_noise(self, fit: LawFit) -> bool:
        """Whether what is left is noise, and commissioning errors are credible."""
        return self.score(fit) < self.limits.misfit and fit.fit.pull < self.limits.pull

    @property
    def reason(self) -> str:
        """Why the best law is not claimed; empty where it may be."""
        if self.nats < CLAIM:
            return f"it is only {self.nats:.1f} nats more probable than no law"
        if self.score(self.best) >= self.limits.misfit:
            return "what it leaves is not noise"
        if self.best.fit.pull >= self.limits.pull:
            return f"it needs a commissioning error of {self.best.fit.pull:.1f} sd"
        if self.further > CLAIM + self.allowance(self.best):
            return "something more is left beside it"
        return ""


def search_laws(
    evidence: Evidence, commissioning: Fit, limits: Limits, progress: Progress = silent
) -> Search | None:
    """Fit laws of every place and variable, and closed forms, memories and stops beside them.

    Args:
        evidence: what was measured; its runs are of a `LawForward`.
        commissioning: fit of commissioning errors alone.
        limits: of a claim.
        progress: told how far it is.

    Returns:
        None where no place has a variable that moves, or no law can be simulated.
    """
    plant = evidence.runs.forward
    if not isinstance(plant, LawForward):
        raise TypeError(f"{type(plant).__name__} has no places for laws")
    places = plant.law_places()
    none = fit_law(evidence, None, commissioning)
    ends = ranges(plant, none)
    lean = isinstance(evidence, LeanEvidence)
    smooth = smooth_candidates(places, ends, lean)
    if not smooth:
        return None
    suspects = law_screen(evidence, smooth, none, progress)
    single = [s for s in suspects if isinstance(s.candidate, Table)]
    tables = _tables(evidence, single, none, progress)
    tables = _first([*tables, *_loud(evidence, none, places)], len(single))
    if not tables:
        return None
    others = memory_laws(evidence, none, places, progress)
    if not _quiet(evidence, none, tables[0], limits):
        pairs = [s for s in suspects if isinstance(s.candidate, Mesh)]
        tables += _tables(evidence, pairs, none, progress)
        near = _toned(places, tables) if lean else places
        others += tone_laws(evidence, none, near, ends, 0.5 * suspects[0].gain, progress)
    best = max([*tables, *others], key=lambda fit: fit.log_evidence)
    second = adapted(evidence, best.fit)
    none = _again(second, none)
    ends = both(ends, ranges(plant, best))
    tables = _refitted(_first(tables, 3), lambda fit: _further(second, fit, ends), progress)
    others = [_again(second, fit) for fit in _first(others, 3)]
    progress(0.0, "adding knots")
    fine = resolved(second, tables[0])
    if fine is not tables[0] and fine.candidate is not None:
        tables = [fine, *tables[1:]]
        others += tone_laws(second, none, [fine.candidate.place], ends, WORTH, progress)
    worth = [f for f in tables if f.log_evidence > none.log_evidence + WORTH]
    plain = [fit for fit in worth if isinstance(fit.candidate, Table)]
    plain = [fit for fit in plain if fit.log_evidence > plain[0].log_evidence - NEAR]
    closed = [fit for t in plain[:2] for fit in closed_forms(second, t, ends, progress)]
    pool = [*tables, *others, *closed]
    if not any(_quiet(second, none, fit, limits) for fit in _first(pool, 3)):
        pool += stop_laws(second, none, _joints(worth), ends, progress)
    return _chosen(second, none, pool, smooth, limits, progress)


def _further(evidence: Evidence, fit: LawFit, ends: Mapping[str, tuple[float, float]]) -> LawFit:
    """A table once more, to the ends that the motion has with the law in it."""
    table = fit.candidate
    if not isinstance(table, Table):
        return _again(evidence, fit)
    variable = table.of[0]
    return _on(evidence, fit, table, knots(variable, ends[variable.name]))


def _on(evidence: Evidence, fit: LawFit, table: Table, at: tuple[float, ...]) -> LawFit:
    """A table once more on other knots."""
    law = table.law(fit.numbers)
    return fit_law(evidence, replace(table, knots=at), fit.fit, law.at(np.array(at)))


def resolved(evidence: Evidence, fit: LawFit) -> LawFit:
    """A table on as many knots as its record has evidence for.

    Of a ripple of five periods the usual knots make another curve, which may leave no more than
    what the simulation may be off.
    """
    while isinstance(table := fit.candidate, Table) and len(table.knots) < FINEST:
        ends = table.knots[0], table.knots[-1]
        finer = _on(evidence, fit, table, knots(table.of[0], ends, 2 * len(table.knots) - 1))
        if not finer.log_evidence > fit.log_evidence + WORTH:
            break
        fit = finer
    return fit


def _quiet(evidence: Evidence, none: LawFit, fit: LawFit, limits: Limits) -> bool:
    return Search(evidence, none, (fit,), 0.0, limits).leaves_noise(fit)


def _tables(
    evidence: Evidence, suspects: Sequence[Suspect], none: LawFit, progress: Progress
) -> list[LawFit]:
    """The likeliest tables of the screen, or the likeliest meshes, fitted."""
    near = suspects[0].gain - NEAR if suspects else 0.0
    chosen = [s for n, s in enumerate(suspects[:MOST]) if n < LEADERS or s.gain > near]
    begun = []
    for n, suspect in enumerate(chosen):
        progress(n / len(chosen), "fitting laws")
        begun.append(fit_law(evidence, suspect.candidate, none.fit, rounds=BEGUN))
    begun = _first(begun, len(begun))
    lead = begun[0].log_evidence - NEAR if begun else 0.0
    ended = [
        _again(evidence, fit) if n < 2 or fit.log_evidence > lead else fit
        for n, fit in enumerate(begun)
    ]
    return _first(ended, len(ended))


def _loud(evidence: Evidence, none: LawFit, places: Sequence[LawPlace]) -> list[LawFit]:
    """The likeliest tables by inverse dynamics, fitted from what it says, tolerances unstrained."""
    begin = replace(none.fit, shift=np.zeros_like(none.fit.shift), step_share=0.0)
    suspects = loud_screen(evidence, none, places)[:LOUDEST]
    return [fit_law(evidence, one.candidate, begin, one.numbers) for one in suspects]


def _chosen(
    evidence: Evidence,
    none: LawFit,
    pool: Sequence[LawFit],
    smooth: Sequence[Candidate],
    limits: Limits,
    progress: Progress,
) -> Search:
    """The leaders with the noise that the best leaves; of equals the one with least numbers."""
    kept = _first(pool, KEPT)
    table = next((f for f in _first(pool, len(pool)) if f.candidate and f.candidate.kernels), None)
    kept += [table] if table is not None and table not in kept else []
    third = adapted(evidence, kept[0].fit)
    none = _again(third, none)
    again = _refitted(kept, lambda fit: _again(third, fit), progress)
    found = Search(third, none, tuple(again), 0.0, limits)
    lead = again[0].log_evidence - found.allowance(again[0])
    near = [f for f in again if f.log_evidence >= lead and found.leaves_noise(f)]
    best = min(near, key=lambda f: (f.count, -f.log_evidence)) if near else again[0]
    rest = [fit for fit in again if fit is not best]
    beside = law_screen(third, _other(smooth, best), best, progress)
    return replace(found, pool=(best, *rest), further=max(beside[0].gain, 0.0))


def _toned(places: Sequence[LawPlace], tables: Sequence[LawFit]) -> list[LawPlace]:
    """Where tones are looked for if runs are dear: columns, which cost none, and leading places."""
    lead = [fit.candidate.place for fit in tables[:2] if fit.candidate is not None]
    return [place for place in places if place.kind is LawKind.READING or place in lead]


def _other(smooth: Sequence[Candidate], best: LawFit) -> list[Candidate]:
    """Those that are not the same family."""
    return [one for one in smooth if best.candidate and one.label != best.candidate.label]


def _joints(fits: Sequence[LawFit]) -> list[LawPlace]:
    """Joints at which laws of efforts were fitted, each once."""
    places = [fit.candidate.place for fit in fits if fit.candidate is not None]
    return [p for p in dict.fromkeys(places) if p.kind is LawKind.EFFORT]


def _again(evidence: Evidence, fit: LawFit) -> LawFit:
    return fit_law(evidence, fit.candidate, fit.fit, fit.numbers)


def _refitted(
    fits: Sequence[LawFit], refit: Callable[[LawFit], LawFit], progress: Progress
) -> list[LawFit]:
    """Fits once more, by falling evidence."""
    found = []
    for n, fit in enumerate(fits):
        progress(n / len(fits), "fitting the likeliest laws again")
        found.append(refit(fit))
    return _first(found, len(found))


def _first(fits: Sequence[LawFit], count: int) -> list[LawFit]:
    """By falling evidence; what failed is left out."""
    sound = [fit for fit in fits if np.isfinite(fit.log_evidence)]
    return sorted(sound, key=lambda fit: -fit.log_evidence)[:count]
