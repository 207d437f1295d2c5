"""law_screen: every place and variable by the evidence of one linearisation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ves_twin.core.types import FloatArray, SingleArray
from ves_twin.diagnosis.law.candidate import Candidate, Mesh, Table
from ves_twin.diagnosis.law.fit_law import LawFit
from ves_twin.diagnosis.law.lean import LeanEvidence
from ves_twin.diagnosis.law.smoothness import Smoothness, smoothest
from ves_twin.diagnosis.law.with_law import WithLaw
from ves_twin.diagnosis.model.law_forward import LawForward, LawPlace, Variable
from ves_twin.diagnosis.record.evidence import Evidence
from ves_twin.diagnosis.record.runs import Progress, Runs, silent
from ves_twin.effects.law import LawKind, variable_along

KNOTS = {"position": 19, "speed": 21, "time": 25, "command": 13}
"""Of a table, by what it depends on: those of speed are closer about zero."""

COARSE = {"position": 7, "speed": 9, "time": 9, "command": 7}
"""The same where runs are dear: what is fitted gets more."""

FITTED = 1500
"""Predictions that the fits of a search take, on the pendulum."""

FITTED_LEAN = 300
"""The same of a lean search, on VES II."""

MESHED = 8
"""Knots of each variable of a mesh."""

LEAST = 1e-3
"""Distance of a knot from the ends, as a share of the largest speed."""

CROWDED = 3.0
"""Knots of speed are m sinh(CROWDED z) / sinh(CROWDED), z even."""


@dataclass(frozen=True)
class Suspect:
    """A candidate and its evidence over no law, by one linearisation."""

    candidate: Candidate
    smoothness: Smoothness

    @property
    def gain(self) -> float:
        """Log evidence over no law [nats]."""
        return self.smoothness.gain


def ranges(forward: LawForward, found: LawFit) -> Mapping[str, tuple[float, float]]:
    """Ends of every variable in the recordings, as a fit simulates them."""
    runs = found.fit.local.runs
    names = {variable.name for place in forward.law_places() for variable in place.variables}
    laws = [found.candidate.law(found.numbers)] if found.candidate else []
    ends: dict[str, tuple[float, float]] = {}
    for programme, values in zip(runs.programmes, values_of(runs, found.fit.shift), strict=True):
        path = forward.visited(programme, values, laws)
        for name in names:
            rows = variable_along(name, path)
            low, high = ends.get(name, (np.inf, -np.inf))
            ends[name] = min(low, float(np.min(rows))), max(high, float(np.max(rows)))
    return ends


def both(
    one: Mapping[str, tuple[float, float]], other: Mapping[str, tuple[float, float]]
) -> Mapping[str, tuple[float, float]]:
    """Ends that hold both ranges."""
    return {
        name: (min(low, other[name][0]), max(high, other[name][1]))
        for name, (low, high) in one.items()
    }


def values_of(runs: Runs, shift: FloatArray) -> list[dict[str, float]]:
    """Parameter -> value of the plant, of each recording."""
    found = [runs.values(k, shift) for k in range(len(runs.programmes))]
    forward = runs.forward
    return [forward.of_plant(one) for one in found] if isinstance(forward, WithLaw) else found


def runs_of(places: Sequence[LawPlace], lean: bool) -> int:
    """Predictions that a search takes, about: two screens, and fits of the leaders."""
    joints = [place for place in places if place.kind is LawKind.EFFORT]
    if lean:
        return FITTED_LEAN + sum(COARSE[v.what] for place in joints for v in place.variables)
    tables = sum(KNOTS[v.what] for place in joints for v in place.variables)
    return FITTED + 2 * (tables + MESHED**2 * len(joints))


def smooth_candidates(
    places: Sequence[LawPlace], ends: Mapping[str, tuple[float, float]], lean: bool = False
) -> list[Candidate]:
    """A table of every variable at every place, and a mesh of a joint's own position and speed.

    Where runs are dear, coarse tables alone.
    """
    found: list[Candidate] = []
    count = COARSE if lean else KNOTS
    for place in places:
        moving = [v for v in place.variables if v.name in ends and _wide(ends[v.name])]
        found += [Table(place, (v,), knots(v, ends[v.name], count[v.what])) for v in moving]
        own = {v.what: v for v in reversed(moving)}
        if lean or place.kind is not LawKind.EFFORT:
            continue
        if {"position", "speed"} <= own.keys():
            pair = own["position"], own["speed"]
            first, second = (tuple(np.linspace(*ends[v.name], MESHED).tolist()) for v in pair)
            found.append(Mesh(place, pair, (first, second)))
    return found


def law_screen(
    evidence: Evidence,
    candidates: Sequence[Candidate],
    about: LawFit,
    progress: Progress = silent,
) -> list[Suspect]:
    """Candidates by falling evidence beside a fit.

    Args:
        evidence: what was measured.
        candidates: with smooth priors.
        about: where the linearisation is: commissioning errors alone, or with a law.
        progress: told how far it is.
    """
    z = about.fit.residual + about.jacobian @ about.point
    found = []
    for n, candidate in enumerate(candidates):
        progress(n / len(candidates), "screening laws")
        columns = columns_about(evidence, candidate, about)
        found.append(
            Suspect(candidate, smoothest(columns, about.jacobian, z, about.temper, candidate))
        )
    return sorted(found, key=lambda s: -s.gain)


def columns_about(evidence: Evidence, candidate: Candidate, about: LawFit) -> FloatArray:
    """Whitened change (samples, k) for a unit of each number of a further law beside a fit."""
    if not isinstance(evidence, LeanEvidence):
        return evidence.whitening.apply(_changes(evidence, candidate, about)).T
    known = evidence.hats.changes(candidate, candidate.start)
    if known is None:
        known = _changes(evidence, candidate, about)
        evidence.hats.keep(candidate, known)
    return evidence.whitening.apply(known).T


def _changes(evidence: Evidence, candidate: Candidate, about: LawFit) -> SingleArray:
    """The same in the channels' units (k, rows, c)."""
    whole = tuple(one for one in (about.candidate, candidate) if one is not None)
    runs = replace(evidence.runs, forward=WithLaw(_plant(evidence), whole))
    shift = runs.origin
    shift[: len(about.fit.shift)] = about.fit.shift
    law = np.arange(len(shift) - len(candidate.sd), len(shift))
    moved = [
        runs.depart(shift, law[[n]], shift[law[n]] + step) for n, step in enumerate(candidate.steps)
    ]
    share = (1.0 / candidate.steps).astype(np.float32)[:, None, None]
    change = (runs.many(moved) - about.fit.prediction) * share
    change[~np.isfinite(change).all(axis=(1, 2))] = 0.0
    return np.asarray(change)


def _plant(evidence: Evidence) -> LawForward:
    forward = evidence.runs.forward
    if not isinstance(forward, LawForward):
        raise TypeError(f"{type(forward).__name__} has no places for laws")
    return forward


def _wide(ends: tuple[float, float]) -> bool:
    return bool(np.isfinite(ends).all()) and ends[1] > ends[0]


def knots(
    variable: Variable, ends: tuple[float, float], count: int | None = None
) -> tuple[float, ...]:
    """Of a table: even, those of speed closer about zero; as many as usual if nobody says."""
    low, high = ends
    count = count or KNOTS[variable.what]
    if variable.what != "speed":
        return tuple(np.linspace(low, high, count).tolist())
    most = max(-low, high)
    every = most * np.sinh(CROWDED * np.linspace(-1.0, 1.0, count)) / np.sinh(CROWDED)
    inside = every[(every > low + LEAST * most) & (every < high - LEAST * most)]
    return tuple([low, *inside.tolist(), high])
