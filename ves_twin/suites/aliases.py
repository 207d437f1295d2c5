"""aliases: what else of the library would leave hardly anything of a cause."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.bank.screen import Candidate, Screen
from ves_twin.diagnosis.bank.signature_library import SignatureLibrary, build_bank
from ves_twin.diagnosis.fit.refine import refine, residual_about
from ves_twin.diagnosis.record.evidence import Evidence
from ves_twin.diagnosis.record.runs import Progress, Runs, silent
from ves_twin.diagnosis.record.whitening import whitening_declared
from ves_twin.suites.draw import DETECTABILITY
from ves_twin.suites.truth import Truth

NEARLY = 1.5
"""A group that leaves more than this times DETECTABILITY[0] by the columns is not tried."""

TRIED = 24
"""Pairs at most that the full forward tries for one cause, those that leave least first."""

ANY_SCALE = (0.0, np.inf)
"""Two causes that nearly cancel need more of each than a diagnosis would begin with."""


def aliases(
    runs: Runs, truths: Sequence[Truth], progress: Progress = silent
) -> list[tuple[tuple[str, ...], ...]]:
    """Causes, alone or two together, that a cause could be taken for at its size.

    An alias leaves d < DETECTABILITY[0] of the cause's trace at noise and tolerances as declared,
    its own sizes and the commissioning errors fitted by the full forward, as for the d of the
    cause itself: less than a diagnosis is asked to see. It is told before anything is diagnosed.

    Args:
        runs: of the programme.
        truths: each with one cause.
        progress: told how far it is.
    """
    if not truths:
        return []
    bank = build_bank(runs, progress=progress)
    screen, found = Screen(bank, whitening_declared(runs)), []
    for n, truth in enumerate(truths):
        progress(n / len(truths), "what each cause left out could be taken for")
        found.append(_of(screen, bank, truth))
    return found


def _of(screen: Screen, bank: SignatureLibrary, truth: Truth) -> tuple[tuple[str, ...], ...]:
    runs, cause = bank.base.runs, truth.causes[0]
    labels = [hypothesis.label for hypothesis in bank.hypotheses]
    hidden = labels.index(cause.label)
    shift = runs.origin
    names = bank.hypotheses[hidden].parameters
    shift[runs.indices(bank.hypotheses[hidden])] = [cause.departures[name] for name in names]
    evidence = Evidence(runs, runs.one(shift), screen.whitening)
    starts = [runs.origin, np.where(runs.sd > 0.0, shift, 0.0)]
    usual = min((refine(evidence, (), s, bank.base) for s in starts), key=lambda fit: fit.chi2)
    found: set[frozenset[int]] = set()
    for group in _near(screen, residual_about(evidence, usual, bank.base), hidden):
        numbers = frozenset(suspect.hypothesis for suspect in group)
        if any(fewer <= numbers for fewer in found):
            continue
        free, start = tuple(bank.hypotheses[suspect.hypothesis] for suspect in group), usual.shift
        for suspect, hypothesis in zip(group, free, strict=True):
            start = runs.depart(start, runs.indices(hypothesis), suspect.sizes)
        if refine(evidence, free, start, bank.base).chi2 < DETECTABILITY[0] ** 2:
            found.add(numbers)
    # with another cause beside it, an alias leaves no more than alone
    rest = set(range(len(labels))) - {hidden}
    found |= {alone | {k} for alone in found if len(alone) == 1 for k in rest - alone}
    groups = sorted((len(numbers), sorted(numbers)) for numbers in found)
    return tuple(tuple(labels[h] for h in numbers) for _, numbers in groups)


def _near(screen: Screen, residual: FloatArray, hidden: int) -> list[tuple[Candidate, ...]]:
    """What may be taken for it, by the columns about the fit; singles first."""
    power = float(residual @ screen.metric.project(residual))
    alone = [(suspect,) for suspect in screen.suspects(residual)]
    every = screen.pairs(residual, len(alone) ** 2, ANY_SCALE)
    pairs = [pair for pair in every if hidden not in (pair[0].hypothesis, pair[1].hypothesis)]
    singles = [one for one in alone if one[0].hypothesis != hidden]
    near = (NEARLY * DETECTABILITY[0]) ** 2
    return [group for group in (*singles, *pairs[:TRIED]) if power - group[0].score < near]
