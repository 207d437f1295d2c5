"""memory_laws, stop_laws: what no function of the present motion alone can be."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import product

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.bank.metric import Metric
from ves_twin.diagnosis.law.candidate import Candidate
from ves_twin.diagnosis.law.contact import Hold, Play, Stop
from ves_twin.diagnosis.law.fit_law import LawFit, fit_law
from ves_twin.diagnosis.law.lean import LeanEvidence
from ves_twin.diagnosis.law.with_law import WithLaw
from ves_twin.diagnosis.model.law_forward import LawPlace
from ves_twin.diagnosis.record.evidence import Evidence
from ves_twin.diagnosis.record.runs import Progress, silent
from ves_twin.effects.law import LawKind, joints_of

HELD = range(2, 15)
"""Rows that a reading may be held."""

LIKELIEST = 2
"""Columns whose memories are fitted where runs are dear, by what those leave as they begin."""

BEGINS = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9)
"""Places of a stop that are tried, as shares of the range."""

STIFFNESS = (5.0, 20.0, 80.0)
"""Stiffnesses of a stop that are tried, in expected efforts over the unit of position."""


def memory_laws(
    evidence: Evidence, about: LawFit, places: Sequence[LawPlace], progress: Progress = silent
) -> list[LawFit]:
    """A play and a hold of every column; of the likeliest ones alone where runs are dear."""
    tried: list[tuple[float, LawPlace, Hold]] = []
    columns = [place for place in places if place.kind is LawKind.READING]
    for n, place in enumerate(columns):
        progress(n / len(columns), "memories of readings")
        held = [Hold(place, (), rows) for rows in HELD]
        left = _left(evidence, [Play(place, ()), *held], about)
        tried.append((float(np.min(left)), place, held[int(np.argmin(left[1:]))]))
    if isinstance(evidence, LeanEvidence):
        tried = sorted(tried, key=lambda one: one[0])[:LIKELIEST]
    laws = [law for _, place, hold in tried for law in (Play(place, ()), hold)]
    return [fit_law(evidence, law, about.fit) for law in laws]


def stop_laws(
    evidence: Evidence,
    about: LawFit,
    places: Sequence[LawPlace],
    ends: Mapping[str, tuple[float, float]],
    progress: Progress = silent,
) -> list[LawFit]:
    """A stop on either side of each joint: the best of a few begins and stiffnesses, fitted."""
    found = []
    for place in places:
        positions = [v for v in place.variables if v.name == f"position@{place.name}"]
        if place.kind is not LawKind.EFFORT or not positions or len(joints_of(place.name)) > 1:
            continue
        low, high = ends[positions[0].name]
        wide = high - low
        for side in (1, -1):
            progress(0.5, "stops")
            tried = [
                Stop(place, (positions[0],), side, low + share * wide, k * place.scale, wide)
                for share, k in product(BEGINS, STIFFNESS)
            ]
            best = tried[int(np.argmin(_left(evidence, tried, about)))]
            found.append(fit_law(evidence, best, about.fit, best.start))
    return found


def _left(evidence: Evidence, candidates: Sequence[Candidate], about: LawFit) -> FloatArray:
    """Chi^2 (k,) beside each candidate as it begins, commissioning errors by the columns here."""
    metric, point = Metric(about.jacobian), about.point
    found = []
    for candidate in candidates:
        forward = WithLaw(evidence.runs.forward, (candidate,))  # type: ignore[arg-type]
        runs = replace(evidence.runs, forward=forward)
        shift = runs.origin
        shift[: len(about.fit.shift)] = about.fit.shift
        z = evidence.whitening.apply(evidence.measured - runs.one(shift))
        z = z + about.jacobian[:, :-1] @ point[:-1]
        found.append(float(z @ metric.project(z)) if np.all(np.isfinite(z)) else np.inf)
    return np.array(found)
