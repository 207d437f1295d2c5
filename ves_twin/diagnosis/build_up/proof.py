"""prove: which chosen trials predict held-out rows better, each by itself, beside all others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ves_twin.diagnosis.build_up.bench import Bench
from ves_twin.diagnosis.build_up.judges import Judges
from ves_twin.diagnosis.build_up.paired import Difference
from ves_twin.diagnosis.build_up.regression import Half, Regression

FALSE_SHARE = 0.05
"""False-discovery rate over everything that was put to proof."""

NULL_FROM = 0.5
"""p from which a trial counts as one that held-out rows do not speak for (Storey's lambda)."""

AGAIN = 0.5
"""Share of that rate at which a trial that was dropped may come back: dropping went one by one."""


@dataclass(frozen=True)
class Proof:
    """What held-out rows prove.

    Attributes:
        proved: trials, in the order in which they were chosen.
        differences: paired test of each of them, beside those that were in when it passed best.
        dropped: trials that were put to proof and not proved, with p when they went.
        tested: trials that were put to proof in all.
        limit: largest p that the rate allows them.
        judges: with everything that was put to proof.
    """

    proved: tuple[int, ...]
    differences: dict[int, Difference]
    dropped: dict[int, float]
    tested: int
    limit: float
    judges: Judges

    @property
    def bench(self) -> Bench:
        """By the errors that show all trials together best."""
        return self.judges.first


def prove(
    regression: Regression,
    held: Half,
    chosen: Sequence[int],
    more: int = 0,
    judges: Judges | None = None,
) -> Proof:
    """Drop the least proved trial until the false-discovery rate is kept by all that stay.

    Each is judged by its own paired improvement of held-out rows, all others refitted without it.
    What passes beside more causes than stay is not lost when those go, unless held-out rows then
    speak against it: else one that just fails takes the next with it, as the rest describes less
    (eight more that were put to proof left 4 of TX40's 19). The rate counts those that may be
    false, not those that are plainly there. A single p may be above the rate where many are plainly
    there: a limit of 5 % on each leaves 13.7 % of TX40's torque in place of 9.1 %.

    Source: Benjamini and Hochberg 1995, with Storey's (2002) count of those without an effect, over
    all that were put to proof; dropping one by one is outside their theorem, so that the rate is
    checked by drawing (tests, the workshop suite).

    Args:
        regression: of the fitted half.
        held: the held-out half.
        chosen: trials that are put to proof.
        more: trials that were put to proof before, which count for the rate.
        judges: of these trials; as the fitted half has it if None.
    """
    tested = len(chosen) + more
    broken = held.columns.failed(chosen)
    kept, dropped = [n for n in chosen if n not in broken], dict.fromkeys(broken, 1.0)
    back: list[int] | None = None
    whole = (judges or Judges.of(regression, kept)).on(held)
    if not whole.first.whole.any():
        limit = FALSE_SHARE / max(tested, 1)
        return Proof((), {}, dict.fromkeys(chosen, 1.0), tested, limit, whole)
    at, found = whole, whole.each(kept)
    null = more + _null([found[n].p for n in kept])
    while True:
        passed = _passed(found, null)
        failing = [n for n in kept if n not in passed]
        worst = max(failing, key=lambda n: (found[n].p, -found[n].total), default=None)
        if worst is not None:
            kept.remove(worst)
            dropped[worst] = found[worst].p
        else:
            back = [n for n in dropped if n not in broken] if back is None else back
            again = _again(at, kept, back, null)
            if again is None:
                limit = FALSE_SHARE * max(len(kept), 1) / null
                return Proof(tuple(kept), found, dropped, tested, limit, whole)
            back.remove(again)
            kept.append(again)
            del dropped[again]
        at = whole.fitted(kept)
        before, found = found, at.each(kept)
        for n in passed.intersection(kept):
            if found[n].p <= NULL_FROM:
                found[n] = min(before[n], found[n], key=lambda one: one.p)


def _passed(found: dict[int, Difference], null: float) -> frozenset[int]:
    """As many as have p of no more than the rate times their number, of those that may be false."""
    ranked = sorted(found, key=lambda n: found[n].p)
    enough = [k for k, n in enumerate(ranked, 1) if found[n].p <= FALSE_SHARE * k / null]
    return frozenset(ranked[: max(enough, default=0)])


def _null(p: Sequence[float]) -> float:
    """How many of these trials may be without an effect: at least one, all at most."""
    high = sum(value > NULL_FROM for value in p)
    return float(np.clip((high + 1.0) / (1.0 - NULL_FROM), 1.0, max(len(p), 1)))


def _again(judges: Judges, kept: Sequence[int], back: Sequence[int], null: float) -> int | None:
    """Of those that were dropped the one that held-out rows ask for most now, if they do."""
    if not back:
        return None
    wider = judges.fitted([*kept, *back])
    p = {n: wider.each([*kept, n], [n])[n].p for n in back}
    best = min(back, key=lambda n: p[n])
    return best if p[best] <= AGAIN * FALSE_SHARE * (len(kept) + 1) / null else None
