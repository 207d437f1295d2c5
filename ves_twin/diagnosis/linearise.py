"""Linearisation: what every commissioning tolerance, and the step, change at a point."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ves_twin.core.types import FloatArray, IntArray, SingleArray
from ves_twin.diagnosis.runs import Progress, Runs, silent

STEP_SD = 2.0
"""Prior sd of the discretisation column. A first-order integrator is off by twice what halving its
step changes, a second-order one by 4/3 of it."""

GUESS = 0.1
"""Share of a column that changes over a rig within its tolerances, where that was not measured."""

STIFF = 3.0
"""Change of a column [sigma] below which it is not computed anew at a fit."""

FORWARD_STEP = 1.0
"""Commissioning sd of a one-sided difference at a fit."""


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


def linearise(
    runs: Runs,
    point: FloatArray,
    progress: Progress = silent,
    axes: tuple[IntArray, FloatArray] | None = None,
    forward_step: float | None = None,
) -> Linearisation:
    """Differences over one sd to either side, one-sided at a bound.

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
    where, spreads = (runs.nuisances, runs.sd[runs.nuisances]) if axes is None else axes
    moves = (1.0, -1.0) if forward_step is None else (forward_step, 0.0)
    shifts, weights = [point], []
    for i, sd in zip(where, spreads, strict=True):
        ends = [runs.depart(point, np.array([i]), point[i] + move * sd) for move in moves]
        if ends[0][i] == ends[1][i]:  # at its upper bound
            ends[0] = runs.depart(point, np.array([i]), point[i] - moves[0] * sd)
        shifts += ends if forward_step is None else ends[:1]
        weights.append(sd / (ends[0][i] - ends[1][i]))
    stacks = runs.many(shifts, progress, "commissioning tolerances")
    prediction = stacks[0]
    far = stacks[1:] if forward_step is not None else stacks[1::2]
    near = prediction[None] if forward_step is not None else stacks[2::2]
    columns = list((far - near) * np.array(weights, np.float32)[:, None, None])
    for k, column in enumerate(columns):
        if not np.all(np.isfinite(column)):
            columns[k] = _one_sided(far[k], near[k % len(near)], prediction, np.float32(weights[k]))
    columns.append(np.float32(STEP_SD) * (runs.one(point, refined=True) - prediction))
    found = np.stack(columns)
    return Linearisation(runs, point, prediction, found, GUESS * _sizes(runs, found))


def _one_sided(
    far: SingleArray, near: SingleArray, middle: SingleArray, weight: np.float32
) -> SingleArray:
    """The column from the side on which the plant did not fail; nothing if it did on both."""
    for change in (far - middle, middle - near):
        if np.all(np.isfinite(change)):
            return np.asarray(np.float32(2.0) * weight * change)
    return np.zeros_like(middle) if np.all(np.isfinite(middle)) else middle


def with_bends(base: Linearisation, progress: Progress = silent) -> Linearisation:
    """The same, with its bends as a second linearisation at a drawn rig has them."""
    runs, where = base.runs, base.runs.nuisances
    drawn = np.random.default_rng(0).standard_normal(len(where))
    there = runs.depart(base.point, where, base.point[where] + runs.sd[where] * drawn)
    other = linearise(runs, there, progress, forward_step=FORWARD_STEP)
    if not np.all(np.isfinite(other.columns)):
        return base
    return replace(base, bends=_sizes(runs, other.columns - base.columns))


def renewed(local: Linearisation, point: FloatArray, prediction: SingleArray) -> Linearisation:
    """At another point: columns that bend on the way there are computed, the others stay.

    Args:
        local: with columns that held elsewhere.
        point: departures there.
        prediction: channels there.
    """
    runs = local.runs
    bent = np.flatnonzero(local.bends[:-1] * strangeness(local, prediction) > STIFF)
    axes = runs.nuisances[bent], runs.sd[runs.nuisances[bent]]
    there = linearise(runs, point, axes=axes, forward_step=FORWARD_STEP)
    columns = local.columns.copy()
    columns[[*bent, -1]] = there.columns
    return replace(local, point=point, prediction=there.prediction, columns=columns)


def strangeness(local: Linearisation, prediction: SingleArray) -> float:
    """How far a prediction is off, in what rigs within their tolerances are: 1 at least.

    A cause that moves the channels by more than commissioning errors do bends columns by more, too.
    """
    runs = local.runs
    off = float(_sizes(runs, (prediction - local.prediction)[None])[0])
    usual = float(np.linalg.norm(_sizes(runs, local.columns[:-1])))
    return max(1.0, off / max(usual, 1e-30))


def _sizes(runs: Runs, columns: SingleArray) -> FloatArray:
    sds = np.array([runs.forward.channels[c].sd for c in runs.columns])
    return np.asarray(np.sqrt(np.sum(np.square(columns / sds, dtype=float), axis=(1, 2))))
