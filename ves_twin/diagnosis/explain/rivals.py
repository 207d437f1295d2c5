"""Rival: a cause that was considered, and why it was kept or lost."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from ves_twin.diagnosis.fit.assess import Assessment
from ves_twin.diagnosis.fit.explanation import Explanation
from ves_twin.diagnosis.fit.refine import Fit
from ves_twin.diagnosis.model.forward import Channel
from ves_twin.diagnosis.record.adequacy import EnergyCell, cells

NEAR = 0.01
"""Share of an end of its range within which a departure is at that end: bounds hold it there."""

SCREENED = 6
"""Causes that are told though the screen kept them from a fit."""


class Standing(StrEnum):
    """What became of a cause.

    kept: it explains the record as well as any. lost: fitted, and clearly worse. alone: fitted
    without a second cause, and not enough. screened: another was so much likelier that it was not
    fitted.
    """

    KEPT = "kept"
    LOST = "lost"
    ALONE = "alone"
    SCREENED = "screened"


@dataclass(frozen=True)
class Place:
    """Band [Hz] or stretch [s] where a rival leaves most more than the best: both rms [sigma]."""

    channel: str
    kind: str
    low: float
    high: float
    rival: float
    best: float


@dataclass(frozen=True)
class Rival:
    """One explanation that was tried.

    Attributes:
        causes: effect@target of each of its causes.
        sizes: fitted departures of their parameters, with units; empty if not fitted.
        standing: what became of it.
        behind: chi^2 that it leaves more than the best; None if it was not fitted, or breaks off.
        score: chi^2 that the screen expects it to take away; None if it was fitted.
        pull: largest commissioning error that it needs, in declared sd; None if it was not fitted.
        place: where it leaves most more; None for the best, and for one that only loses by the
            commissioning errors it needs.
        ended: whether an end of its range holds a size: a wider one may let it explain more.
    """

    causes: tuple[str, ...]
    sizes: tuple[tuple[float, str], ...]
    standing: Standing
    behind: float | None
    score: float | None
    pull: float | None
    place: Place | None
    ended: bool = False


def rivals_of(first: Assessment, found: Explanation | None) -> tuple[Rival, ...]:
    """Everything that was considered: what was kept first, what the screen held back last.

    Args:
        first: the record before any cause, with the screen's suspects.
        found: the explanation; None gives no rivals.
    """
    if found is None:
        return ()
    told = [_fitted(found, fit, Standing.KEPT) for fit in found.chosen]
    lost = (*found.fits, *found.hopeless)
    others = [(fit, Standing.LOST) for fit in lost] + [(fit, Standing.ALONE) for fit in found.alone]
    causes = {one.causes for one in told}
    for fit, standing in others:  # the nearest of several fits of the same causes stands for them
        one = _fitted(found, fit, standing)
        told += [one] * (one.causes not in causes)
        causes.add(one.causes)
    known = {label for rival in told for label in rival.causes}
    held = [
        (first.screen.bank.hypotheses[s.hypothesis].label, s.score)
        for s in first.suspects
        if s.score > 0.0
    ]
    held = [(label, score) for label, score in held if label not in known][:SCREENED]
    told += [Rival((a,), (), Standing.SCREENED, None, score, None, None) for a, score in held]
    return tuple(told)


def _fitted(found: Explanation, fit: Fit, standing: Standing) -> Rival:
    runs = found.evidence.runs
    free = fit.active[: len(fit.sizes)]
    units = [runs.coordinates[int(i)].parameter.unit for i in free]
    channels = [runs.forward.channels[c] for c in runs.columns]
    behind = fit.chi2 - found.best.chi2
    return Rival(
        causes=tuple(h.label for h in fit.causes),
        sizes=tuple((float(s), unit) for s, unit in zip(fit.sizes, units, strict=True)),
        standing=standing,
        behind=max(behind, 0.0) if np.isfinite(behind) else None,
        score=None,
        pull=fit.pull,
        place=_place(found, fit, channels),
        ended=any(
            (runs.low[i] < 0.0 and size <= (1.0 - NEAR) * runs.low[i])
            or (runs.high[i] > 0.0 and size >= (1.0 - NEAR) * runs.high[i])
            for i, size in zip(free, fit.sizes, strict=True)
        ),
    )


def _place(found: Explanation, fit: Fit, channels: Sequence[Channel]) -> Place | None:
    best = found.best
    more = float(fit.residual @ fit.residual - best.residual @ best.residual)
    if fit is best or more < 0.5 * (fit.chi2 - best.chi2):
        return None
    there = cells(found.evidence.whitening, fit.residual)
    pairs = list(zip(there, found.after, strict=True))
    worse, same = max(pairs, key=lambda pair: pair[0].energy - pair[1].energy)
    channel = channels[worse.channel].name
    return Place(channel, worse.kind, worse.low, worse.high, _rms(worse), _rms(same))


def _rms(cell: EnergyCell) -> float:
    return float(np.sqrt(cell.energy / cell.freedom))
