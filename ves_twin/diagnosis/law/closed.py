"""closed_forms: one or two closed forms in place of a table, by its quadratic form, then fitted."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.law.candidate import Candidate, Closed, Table
from ves_twin.diagnosis.law.fit_law import LawFit, fit_law
from ves_twin.diagnosis.law.forms import FORMS
from ves_twin.diagnosis.law.screen import columns_about
from ves_twin.diagnosis.law.sizes import Sizes
from ves_twin.diagnosis.law.smoothness import projected
from ves_twin.diagnosis.record.evidence import Evidence
from ves_twin.diagnosis.record.runs import Progress, silent

COST = 7.0
"""Chi^2 that a number must take away to be worth it, before the full fit weighs it in nats."""

PAIRS, SINGLES = 3, 2
"""Sums of two, and single forms, that are fitted with the full forward."""

APART = 1e-6
"""Share of a pair's own squares below which two forms are one here."""


def closed_forms(
    evidence: Evidence,
    table: LawFit,
    ends: Mapping[str, tuple[float, float]],
    progress: Progress = silent,
) -> list[LawFit]:
    """Fits of the best closed forms of a table's place and variable.

    Each form's column is computed beside the table, all of one or two forms are ranked by
    chi^2 = -g' G^-1 g + COST for each number, and the best are fitted with the full forward; of
    the best sum each form alone too, since loud laws bend what the quadratic form foretells.
    """
    if not isinstance(table.candidate, Table):
        return []
    entries = _entries(table.candidate, ends)
    every = Sizes(table.candidate.place, table.candidate.of, tuple(entries))
    columns = columns_about(evidence, every, table)
    z = table.fit.residual + table.jacobian @ table.point
    gram, slope = projected(columns, table.jacobian[:, table.count :], z, table.temper)
    gram = gram + np.diag(1.0 / np.square([e.sd[0] for e in entries]))

    def fitted(which: Sequence[int], about: LawFit) -> LawFit:
        """From the sizes that the quadratic form has: from none a loud law is out of reach."""
        at = np.array(which)
        sizes = np.linalg.solve(gram[np.ix_(at, at)], slope[at])
        parts = [[size, *entries[n].inner[0]] for size, n in zip(sizes, which, strict=True)]
        return fit_law(
            evidence, _sum([entries[n] for n in which]), about.fit, np.concatenate(parts)
        )

    chosen, found = _ranked(gram, slope, entries), []
    for n, which in enumerate(chosen):
        progress(n / len(chosen), "closed forms")
        found.append(fitted(which, table))
    first = max(range(len(found)), key=lambda n: found[n].log_evidence)
    if len(chosen[first]) > 1:
        tried = {entries[which[0]].label for which in chosen if len(which) == 1}
        alone = [n for n in chosen[first] if entries[n].label not in tried]
        found += [fitted((n,), found[first]) for n in alone]
    return found


def _entries(candidate: Candidate, ends: Mapping[str, tuple[float, float]]) -> list[Closed]:
    """Every form at every start."""
    variable = candidate.of[0]
    low, high = ends[variable.name]
    found: list[Closed] = []
    for form in FORMS[variable.what]:
        for start in form.starts:
            base = low if form.relative else 0.0
            inner = tuple(base + share * (high - low) for share in start)
            found.append(Closed(candidate.place, candidate.of, (form,), (inner,), (low, high)))
    return found


def _ranked(
    gram: FloatArray, slope: FloatArray, entries: Sequence[Closed]
) -> list[tuple[int, ...]]:
    """The best sums of two and the best single forms, each set of forms once."""
    count = len(entries)
    pay = COST * np.array([1 + len(e.inner[0]) for e in entries])
    own = np.diag(gram)
    single = pay - np.square(slope) / own
    i, k = np.triu_indices(count, 1)
    determinant = own[i] * own[k] - np.square(gram[i, k])
    apart = determinant > APART * own[i] * own[k]
    fall = own[k] * slope[i] ** 2 - 2.0 * gram[i, k] * slope[i] * slope[k] + own[i] * slope[k] ** 2
    pairs = pay[i] + pay[k] - fall / np.where(apart, determinant, np.inf)
    ranked = [
        *((float(cost), (n,)) for n, cost in enumerate(single)),
        *((float(pairs[n]), (int(i[n]), int(k[n]))) for n in np.argsort(pairs)[:40]),
    ]
    found: dict[tuple[str, ...], tuple[int, ...]] = {}
    for _, which in sorted(ranked):
        found.setdefault(tuple(sorted(entries[n].forms[0].name for n in which)), which)
    best = list(found.values())
    return best[:PAIRS] + [which for which in best[PAIRS:] if len(which) == 1][:SINGLES]


def _sum(parts: Sequence[Closed]) -> Closed:
    """One candidate of several forms."""
    forms, inner = tuple(p.forms[0] for p in parts), tuple(p.inner[0] for p in parts)
    return replace(parts[0], forms=forms, inner=inner)
