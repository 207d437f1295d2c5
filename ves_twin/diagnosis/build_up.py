"""build_up: causes one after another, where two do not explain a record, proved on other ones."""

from __future__ import annotations

from collections.abc import Callable

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.explain import Explanation, FitContext, judge, suspects_at
from ves_twin.diagnosis.forward import Hypothesis
from ves_twin.diagnosis.gain import Gain
from ves_twin.diagnosis.refine import Fit, refine

ADDS = 0.25
"""Share of the held-out excess without it that each cause must take, lower end."""

TRIED = 3
"""Suspects that are fitted for one place."""

Proof = Callable[[Fit, Fit], Gain]
"""Held-out gain from one fit to another."""


def build_up(desk: FitContext, start: Explanation, proof: Proof) -> Explanation:
    """Add the best further cause until none is a gain; then drop those that are not proved.

    While causes are missing their trace hides what one more is worth, so the strict proof is last.
    A cause is proved if held-out recordings get clearly worse without it, and with any other cause
    in its place. What is left may be more than noise: the verdict says so.

    Args:
        desk: the record and what noise does.
        start: the best single cause, or pair.
        proof: on held-out recordings.
    """
    here = start
    while not here.adequate and len(here.best.causes) < desk.settings.causes:
        there = _more(desk, here)
        if there is None or not proof(here.best, there.best).passed:
            break
        here = there
    while len(here.best.causes) > 1:
        weak = _unproved(desk, here, proof)
        if weak is None:
            break
        kept = tuple(h for h in here.best.causes if h is not weak)
        here = judge(desk, [_without(here, kept)])
    return here


def _adds(gain: Gain) -> bool:
    return gain.low is not None and gain.low > ADDS


def _more(desk: FitContext, here: Explanation) -> Explanation | None:
    """The best explanation with one cause more."""
    fits = _with_one(desk, here, here.best)
    return judge(desk, fits) if fits else None


def _with_one(
    desk: FitContext, here: Explanation, fit: Fit, but: Hypothesis | None = None, rounds: int = 1
) -> list[Fit]:
    """Fits of further causes, but one, beside those of a fit, by a bank linearised there."""
    rest, suspects = suspects_at(desk, here.evidence, fit)
    likely = [s for s in suspects if rest[s.hypothesis] is not but][:TRIED]
    likely = [s for s in likely if s.score > desk.thresholds.effect]
    return [_grown(here, fit, rest[s.hypothesis], s.sizes, rounds) for s in likely]


def _grown(here: Explanation, fit: Fit, more: Hypothesis, sizes: FloatArray, rounds: int) -> Fit:
    runs = here.evidence.runs
    where = runs.indices(more)
    shift = runs.depart(fit.shift, where, fit.shift[where] + sizes)
    return refine(here.evidence, (*fit.causes, more), shift, fit.local, rounds)


def _without(here: Explanation, kept: tuple[Hypothesis, ...]) -> Fit:
    """The best fit with some of its causes back where they were, or within commissioning."""
    runs, shift = here.evidence.runs, here.best.shift.copy()
    for cause in here.best.causes:
        where = runs.indices(cause)
        if cause not in kept:
            shift[where] = shift[where] * (runs.sd[where] > 0.0)
    return refine(here.evidence, kept, shift, here.best.local, 1)


def _unproved(desk: FitContext, here: Explanation, proof: Proof) -> Hypothesis | None:
    """The cause that held-out recordings miss least, if they do not miss it or take another."""
    causes = here.best.causes
    without = {c: _without(here, tuple(h for h in causes if h is not c)) for c in causes}
    gains = {c: proof(fit, here.best) for c, fit in without.items()}
    weak = [c for c in causes if not _adds(gains[c])]
    if not weak:
        for n, cause in enumerate(causes):
            desk.progress(n / len(causes), "proving each cause")
            others = _with_one(desk, here, without[cause], cause, 0)
            if not all(_adds(proof(fit, here.best)) for fit in others):
                weak.append(cause)
    return min(weak, key=lambda cause: gains[cause].share or 0.0) if weak else None
