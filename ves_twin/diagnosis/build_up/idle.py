"""idle: a proved trial that takes nothing away once all of them are fitted in full."""

from __future__ import annotations

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.build_up.halves import carried_point
from ves_twin.diagnosis.build_up.proof import Proof
from ves_twin.diagnosis.preprocess import Dataset
from ves_twin.diagnosis.refine import Fit
from ves_twin.diagnosis.runs import Runs


def idle(proof: Proof, fitted: Runs, held: Dataset, fit: Fit) -> int | None:
    """The trial without which held-out rows are predicted no worse, all else as it was fitted.

    Trials are proved by their columns at the sizes that they were chosen at. A full fit may take a
    size to where its cause does nothing, as a Stribeck friction over a speed of 0 (TX40), or all of
    them to where they predict worse than the model as it was given (gains at the end of their range
    for a link that is too short, the double pendulum).

    Args:
        proof: what is proved.
        fitted: runs of the fitted half, whose coordinates the fit has.
        held: the held-out half.
        fit: of all that is proved, with the full simulation.

    Returns:
        The one that is worth least, by the plain error of the channels where it acts; None where
        each is worth something.
    """
    bench = proof.bench
    trials, level = bench.regression.trials, bench.regression.level

    def left(shift: FloatArray) -> FloatArray:
        rows = held.measured - held.runs.one(carried_point(fitted, held.runs, shift))
        return np.square(bench.held.rms(np.asarray(rows, float)) / level)

    beside, worth = left(fit.shift), dict[int, float]()
    for n in proof.proved:
        without = fit.shift.copy()
        without[fitted.indices(trials[n].cause)] = 0.0
        taken = float(np.sum((left(without) - beside)[bench.acts(n)]))
        worth[n] = taken if np.isfinite(taken) else np.inf
    least = min(worth, key=lambda n: worth[n], default=None)
    return least if least is not None and worth[least] <= 0.0 else None
