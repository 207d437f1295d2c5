"""own_motion: what is proved, no name firm of whose own motion a smooth law is left."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.build_up.build_up import Built
from ves_twin.diagnosis.build_up.halves import carried_point
from ves_twin.diagnosis.build_up.leftover_laws import ALIKE
from ves_twin.diagnosis.build_up.paired import paired
from ves_twin.diagnosis.build_up.proof import FALSE_SHARE
from ves_twin.diagnosis.build_up.report import SHAKEN
from ves_twin.diagnosis.build_up.result import BuildUp, Proved
from ves_twin.diagnosis.fit.refine import Fit
from ves_twin.diagnosis.law.candidate import Table
from ves_twin.diagnosis.law.screen import COARSE, knots, values_of
from ves_twin.diagnosis.law.smoothness import best_of, projected
from ves_twin.diagnosis.law.with_law import WithLaw
from ves_twin.diagnosis.model.forward import Hypothesis
from ves_twin.diagnosis.model.law_forward import LawForward, LawPlace
from ves_twin.diagnosis.record.preprocess import Dataset
from ves_twin.diagnosis.record.runs import Progress, Runs, silent
from ves_twin.effects.law import LawKind, joints_of, variable_along

PART = 0.1
"""Share of a cause by which it is changed to see what it does: all of it moves a quarter of a car
to where laws do something else."""


@dataclass(frozen=True)
class _Side:
    """A half of the record at the end of building up: what is left, and how laws change it."""

    runs: Runs
    point: FloatArray
    left: FloatArray

    @staticmethod
    def of(seen: Dataset, fitted: Runs, fit: Fit) -> _Side:
        """With the causes of a fit at work."""
        point = carried_point(fitted, seen.runs, fit.shift)
        left = np.asarray(seen.measured - seen.runs.one(point), float)
        return _Side(seen.runs, point, left)

    def visited(self, plant: LawForward, name: str) -> FloatArray:
        """A variable in all recordings, as the extended model moves (n,)."""
        each = zip(self.runs.programmes, values_of(self.runs, self.point), strict=True)
        return np.concatenate([variable_along(name, plant.visited(one, v)) for one, v in each])

    def columns(self, plant: LawForward, table: Table) -> FloatArray:
        """Change of the channels for a unit of each number of a law (k, rows, c)."""
        runs = replace(self.runs, forward=WithLaw(plant, (table,)))
        shift = runs.origin
        shift[: len(self.point)] = self.point
        law = np.arange(len(self.point), len(shift))
        moved = [runs.depart(shift, law[[n]], step) for n, step in enumerate(table.steps)]
        change = (runs.many(moved) - self.runs.one(self.point)) / table.steps[:, None, None]
        change[~np.isfinite(change).all(axis=(1, 2))] = 0.0
        return np.asarray(change, float)

    def trace(self, cause: Hypothesis) -> FloatArray:
        """How the channels change with a cause at work (rows, c), as laws are told beside it."""
        at = self.runs.indices(cause)
        less = self.runs.depart(self.point, at, (1.0 - PART) * self.point[at])
        return np.asarray(self.runs.one(self.point) - self.runs.one(less), float)


def own_motion(built: Built, progress: Progress = silent) -> BuildUp:
    """What is proved, with no firm name of which a law of the same motion is left.

    A one-sided stop stiffens a joint, so that a cubic spring improves the prediction; what it
    leaves is again a law of where the joint stands. Columns of a smooth law of each joint's own
    position, and of its speed, are fitted to what is left of the fitted half and judged on the
    held-out half. A name goes where they could be most of what its cause does, and take more than
    SHAKEN of its amplitude.

    Args:
        built: what is proved, its fit, and both halves.
        progress: told how far it is.
    """
    fit, runs, report = built.found.best, built.fitted.runs, built.report
    plant = runs.forward
    if not isinstance(plant, LawForward) or any(one.poses for one in runs.programmes):
        return report
    places = [p for p in plant.law_places() if p.kind is LawKind.EFFORT]
    places = [p for p in places if len(joints_of(p.name)) == 1]
    names = [one for one in report.proved if one.firm]
    if not names or not places:
        return report
    mine, yours = _Side.of(built.fitted, runs, fit), _Side.of(built.held, runs, fit)
    traces = {f"{cause.effect}@{cause.target}": mine.trace(cause) for cause in fit.causes}
    found = set[str]()
    for n, place in enumerate(places):
        progress(n / len(places), "laws of the same motion as firm names")
        for table in _tables(plant, place, mine, yours):
            columns, there = mine.columns(plant, table), yours.columns(plant, table)
            less = yours.left - np.tensordot(_numbers(columns, mine, table), there, axes=1)
            found |= {
                one.label
                for one in names
                if _ruled(one, traces[one.label], columns, less, mine, yours)
            }
    proved = tuple(replace(one, firm=one.firm and one.label not in found) for one in report.proved)
    return replace(report, proved=proved)


def _tables(plant: LawForward, place: LawPlace, mine: _Side, yours: _Side) -> list[Table]:
    """Of the joint's own position and of its speed, over both halves; none of what stands."""
    found = []
    own = (f"position@{place.name}", f"speed@{place.name}")
    for variable in (v for v in place.variables if v.name in own):
        rows = np.concatenate([side.visited(plant, variable.name) for side in (mine, yours)])
        low, high = float(np.min(rows)), float(np.max(rows))
        if np.isfinite([low, high]).all() and high > low:
            at = knots(variable, (low, high), COARSE[variable.what])
            found.append(Table(place, (variable,), at))
    return found


def _numbers(columns: FloatArray, side: _Side, table: Table) -> FloatArray:
    """Of the law (k,), by plain squares of each channel in units of what is left there."""
    kept = side.runs.kept
    unit = np.sqrt(np.sum(side.left**2, axis=0, where=kept) / np.maximum(kept.sum(axis=0), 1))
    unit = np.where(unit > 0.0, unit, np.inf)
    design = np.where(kept, columns / unit, 0.0).reshape(len(columns), -1).T
    target = np.where(kept, side.left / unit, 0.0).ravel()
    gram, slope = projected(design, np.zeros((len(target), 0)), target, 1.0)
    smooth = best_of(gram, slope, table)
    prior = np.linalg.inv(max(smooth.size, 1e-9) ** 2 * table.kernels[smooth.length])
    return np.asarray(np.linalg.solve(gram + prior, slope))


def _ruled(
    one: Proved,
    trace: FloatArray,
    columns: FloatArray,
    less: FloatArray,
    mine: _Side,
    yours: _Side,
) -> bool:
    """Whether the law is of the same motion as a cause and takes a good share of its amplitude."""
    names = [mine.runs.forward.channels[c].name for c in mine.runs.columns]
    channel, (before, after) = max(one.takes.items(), key=lambda t: t[1][0] ** 2 - t[1][1] ** 2)
    c = names.index(channel)
    rows = mine.runs.kept[:, c]
    target, basis = (x - np.mean(x, axis=0) for x in (trace[rows, c], columns[:, rows, c].T))
    rest = target - basis @ np.linalg.lstsq(basis, target, rcond=None)[0]
    if not float(rest @ rest) <= (1.0 - ALIKE) * float(target @ target):  # or it broke off
        return False
    rows = yours.runs.kept[:, c]
    old, new = yours.left[rows, c] ** 2, less[rows, c] ** 2
    share = 1.0 - float(np.sum(new)) / max(float(np.sum(old)), 1e-300)
    piece = np.cumsum(np.append(0, np.diff(np.flatnonzero(rows)) > 1))
    enough = share * after**2 > SHAKEN**2 * (before**2 - after**2)
    return enough and paired(old - new, piece).p <= FALSE_SHARE
