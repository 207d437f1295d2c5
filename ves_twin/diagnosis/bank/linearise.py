"""Linearisation: what every commissioning tolerance, and the step, change at a point."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ves_twin.core.types import FloatArray, IntArray, SingleArray
from ves_twin.diagnosis.record.runs import Progress, Runs, silent

STEP_SD = 2.0
"""Prior sd of the discretisation column. A first-order integrator is off by twice what halving its
step changes, a second-order one by 4/3 of it."""

GUESS = 0.1
"""Share of a column that changes over a rig within its tolerances, where that was not measured."""

STIFF = 3.0
"""Change of a column [sigma] below which it is not computed anew at a fit."""

FORWARD_STEP = 1.0
"""Commissioning sd of a one-sided difference at a fit."""

MANY = 3
"""Like causes from which one stands for another."""


@dataclass(frozen=True)
class Linearisation:
    """Prediction at a point and its change for one commissioning sd of each nuisance.

    Attributes:
        runs: of which plant and programmes.
        point: departures where it holds (coordinates,).
        prediction: channels there (rows, c).
        columns: change for one sd of each nuisance, then the discretisation (k + 1, rows, c).
        bends: how much each column changes from here to a rig drawn within its tolerances, as the
            root of the sum of squares over all rows, in declared noise sd (k + 1,).
    """

    runs: Runs
    point: FloatArray
    prediction: SingleArray
    columns: SingleArray
    bends: FloatArray

    @property
    def step_error(self) -> SingleArray:
        """What a first-order integrator's step puts the prediction off by (rows, c)."""
        return np.asarray(2.0 / STEP_SD * self.columns[-1], np.float32)


def linearise(
    runs: Runs,
    point: FloatArray,
    progress: Progress = silent,
    axes: tuple[IntArray, FloatArray] | None = None,
    forward_step: float | None = None,
) -> Linearisation:
    """Differences over one sd to either side; to one side at a bound, and of what is linear.

    Args:
        runs: of which plant and programmes.
        point: where.
        progress: told how far it is.
        axes: coordinates and the sd of each; `runs.nuisances` at their commissioning sd if None.
        forward_step: difference to one side over this many sd instead, for half the runs: good
            enough where what moves on from the point is small, as at a fit.

    Returns:
        Columns in the order of the coordinates; last (f(h/2) - f(h)) times STEP_SD.
    """
    usual = axes is None and forward_step is None
    where = (runs.nuisances, runs.sd[runs.nuisances]) if axes is None else axes

    def compute() -> SingleArray:
        return _differences(runs, point, progress, where, forward_step)

    found = runs.columns_at(point, compute) if usual else compute()
    columns = found[1:]
    return Linearisation(runs, point, found[0], columns, GUESS * _sizes(runs, columns))


def _differences(
    runs: Runs,
    point: FloatArray,
    progress: Progress,
    axes: tuple[IntArray, FloatArray],
    forward_step: float | None,
) -> SingleArray:
    """The prediction at a point, the columns of axes, and of the step (k + 2, rows, c)."""
    straight = _straight(runs)
    shifts, sides = [point], []
    for i, sd in zip(*axes, strict=True):
        step = sd * (1.0 if forward_step is None else forward_step)
        ends = [runs.depart(point, np.array([i]), point[i] + move) for move in (step, -step)]
        moved = [end for end in ends if end[i] != point[i]]
        if forward_step is not None or i in straight:
            moved = moved[:1]
        sides.append(range(len(shifts), len(shifts) + len(moved)))
        shifts += moved
    stacks = runs.many(shifts, progress, "commissioning tolerances")
    columns = [
        _slope(stacks, shifts, side, int(i), float(sd))
        for side, i, sd in zip(sides, *axes, strict=True)
    ]
    finer = np.float32(STEP_SD) * (runs.one(point, refined=True) - stacks[0])
    return np.stack([stacks[0], *columns, finer])


def _straight(runs: Runs) -> frozenset[int]:
    """Coordinates of causes that are linear over their whole range: one side tells it all."""
    linear = [h for h in runs.forward.hypotheses if h.linear]
    return frozenset(int(i) for h in linear for i in runs.indices(h))


def _slope(
    stacks: SingleArray, shifts: Sequence[FloatArray], side: range, axis: int, sd: float
) -> SingleArray:
    """Change for one sd from the first to the last of what was simulated along an axis.

    From the point itself where one side was, or where the plant failed on the other; nothing if it
    failed on both.
    """
    good = [k for k in side if np.all(np.isfinite(stacks[k]))]
    if not good:
        return np.zeros_like(stacks[0]) if np.all(np.isfinite(stacks[0])) else stacks[0]
    far, near = good[0], good[1] if len(good) > 1 else 0
    weight = sd / (shifts[far][axis] - shifts[near][axis])
    return np.asarray((stacks[far] - stacks[near]) * np.float32(weight))


def with_bends(
    base: Linearisation, progress: Progress = silent, together: bool = False
) -> Linearisation:
    """The same, with its bends as they are at a rig drawn within its tolerances.

    Args:
        base: whose columns are tried elsewhere.
        progress: told how far it is.
        together: like tolerances of many parts are moved in one run, one sd each: what their
            columns do not foretell is shared out among them by their sizes.
    """
    runs, where = base.runs, base.runs.nuisances
    rng = np.random.default_rng(0)
    drawn = base.point[where] + runs.sd[where] * rng.standard_normal(len(where))
    there = runs.depart(base.point, where, drawn)
    groups = _moved_together(runs) if together else [np.array([n]) for n in _bending(runs)]
    moves = [_shaken(runs, there, where[rows], rng) for rows in groups]
    stacks = runs.many([there, *moves], progress, "how far tolerances bend")
    finer = np.float32(STEP_SD) * (runs.one(there, refined=True) - stacks[0])
    if not (np.all(np.isfinite(stacks)) and np.all(np.isfinite(finer))):
        return base
    sizes, bends = _sizes(runs, base.columns), np.zeros(len(base.columns))
    for rows, move, stack in zip(groups, moves, stacks[1:], strict=True):
        share = ((move - there)[where[rows]] / runs.sd[where[rows]]).astype(np.float32)
        surprise = stack - stacks[0] - np.tensordot(share, base.columns[rows], axes=1)
        portion = sizes[rows] / max(float(np.linalg.norm(sizes[rows])), 1e-30)
        bends[rows] = portion * _sizes(runs, surprise[None])[0]
    bends[-1] = _sizes(runs, (finer - base.columns[-1])[None])[0]
    return replace(base, bends=bends)


def _bending(runs: Runs) -> list[int]:
    """Rows of the nuisances whose columns may bend: what only adds to the channels does not."""
    axes = [runs.coordinates[i].parameter for i in runs.nuisances]
    return [row for row, parameter in enumerate(axes) if not parameter.additive]


def _moved_together(runs: Runs) -> list[IntArray]:
    """Rows of the nuisances by kind of part; of causes that are not linear, by kind of cause too.

    Tolerances that are no cause go by their part (`table@chamber.viscous`). Fewer than MANY say
    little about each other, and stay alone.
    """
    kinds: dict[int, tuple[str, str]] = {}
    for h in runs.forward.hypotheses:
        kind = ("" if h.linear else h.effect, h.kind[1])
        kinds |= {int(i): kind for i in runs.indices(h)}
    groups: dict[object, list[int]] = {}
    for row in _bending(runs):
        i = int(runs.nuisances[row])
        part = runs.coordinates[i].parameter.name.rpartition(".")[0]
        groups.setdefault(kinds.get(i, part or i), []).append(row)
    found = []
    for rows in groups.values():
        found += [np.array(rows)] if len(rows) >= MANY else [np.array([row]) for row in rows]
    return found


def _shaken(runs: Runs, there: FloatArray, axes: IntArray, rng: np.random.Generator) -> FloatArray:
    """A rig with some coordinates one sd further, to random sides where they are several."""
    signs = rng.choice([-1.0, 1.0], len(axes)) if len(axes) > 1 else np.ones(1)
    moved = runs.depart(there, axes, there[axes] + signs * runs.sd[axes])
    stuck = moved[axes] == there[axes]
    back = runs.depart(there, axes, there[axes] - signs * runs.sd[axes])
    moved[axes[stuck]] = back[axes[stuck]]
    return moved


def renewed(local: Linearisation, point: FloatArray, prediction: SingleArray) -> Linearisation:
    """At another point: columns that bend on the way there are computed, the others stay.

    What columns bend by is told of a rig drawn within its tolerances; the way is as long as that if
    its root mean square is one sd, or if predictions change by as much as such rigs differ.

    Args:
        local: with columns that held elsewhere.
        point: departures there.
        prediction: channels there.
    """
    runs = local.runs
    moved = (point - local.point)[runs.nuisances] / runs.sd[runs.nuisances]
    rms = float(np.linalg.norm(moved)) / np.sqrt(max(len(moved), 1))
    way = max(rms, _strange(local, prediction))
    bent = np.flatnonzero(local.bends[:-1] * way > STIFF)
    axes = runs.nuisances[bent], runs.sd[runs.nuisances[bent]]
    there = linearise(runs, point, axes=axes, forward_step=FORWARD_STEP)
    columns = local.columns.copy()
    columns[[*bent, -1]] = there.columns
    return replace(local, point=point, prediction=there.prediction, columns=columns)


def strangeness(local: Linearisation, prediction: SingleArray) -> float:
    """How far a prediction is off, in what rigs within their tolerances are: 1 at least.

    A cause that moves the channels by more than commissioning errors do bends columns by more, too.
    """
    return max(1.0, _strange(local, prediction))


def _strange(local: Linearisation, prediction: SingleArray) -> float:
    runs = local.runs
    off = float(_sizes(runs, (prediction - local.prediction)[None])[0])
    usual = float(np.linalg.norm(_sizes(runs, local.columns[:-1])))
    return off / max(usual, 1e-30)


def _sizes(runs: Runs, columns: SingleArray) -> FloatArray:
    sds = np.array([runs.forward.channels[c].sd for c in runs.columns])
    return np.asarray(np.sqrt(np.sum(np.square(columns / sds, dtype=float), axis=(1, 2))))
