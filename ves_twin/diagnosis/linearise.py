"""Linearisation: what every commissioning tolerance, and the step, change at a point."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ves_twin.diagnosis.runs import Progress, Runs, silent
from ves_twin.types import FloatArray, IntArray, SingleArray

STEP_SD = 2.0
"""Prior sd of the discretisation column. A first-order integrator is off by twice what halving its
step changes, a second-order one by 4/3 of it."""


@dataclass(frozen=True)
class Linearisation:
    """Prediction at a point and its change for one commissioning sd of each nuisance.

    Attributes:
        runs: of which plant and programmes.
        point: departures where it holds (coordinates,).
        prediction: channels there (rows, c).
        columns: change for one sd of each nuisance, then the discretisation (k + 1, rows, c).
    """

    runs: Runs
    point: FloatArray
    prediction: SingleArray
    columns: SingleArray


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
    columns.append(np.float32(STEP_SD) * (runs.one(point, refined=True) - prediction))
    return Linearisation(runs, point, prediction, np.stack(columns))
