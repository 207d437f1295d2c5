"""idle: a proved trial that takes next to nothing away once all of them are fitted in full."""

from __future__ import annotations

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.build_up.halves import carried_point
from ves_twin.diagnosis.build_up.proof import Proof
from ves_twin.diagnosis.fit.refine import Fit
from ves_twin.diagnosis.record.preprocess import Dataset
from ves_twin.diagnosis.record.runs import Runs

EARNS = 0.01
"""Share of what is left of held-out squares, channels where it acts, that a cause must take away:
half a per cent of an error is no extension that anyone would keep, however sure its sign. Chosen by
what it means; the wrist's tool mass and a link's mass centre that moved by 4 mm were seen."""


def idle(proof: Proof, fitted: Runs, held: Dataset, fit: Fit) -> int | None:
    """The trial without which held-out rows are predicted hardly worse.

    All else as it was fitted, by the full simulation; or all else refitted, by the columns.

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
        each is worth as much as EARNS.
    """
    bench = proof.bench
    trials = bench.regression.trials
    beside, linear = _left(proof, fitted, held, fit.shift), bench.bare(proof.proved)
    worth = dict[int, float]()
    for n in proof.proved:
        without, acts = fit.shift.copy(), bench.acts(n)
        without[fitted.indices(trials[n].cause)] = 0.0
        there = _left(proof, fitted, held, without)
        rest = bench.bare([k for k in proof.proved if k != n])
        shares = _share(there[acts], beside[acts]), _share(rest[acts], linear[acts])
        worth[n] = min(shares)
    least = min(worth, key=lambda n: worth[n], default=None)
    return least if least is not None and worth[least] <= EARNS else None


def missed(proof: Proof, trial: int, fitted: Runs, held: Dataset, fits: tuple[Fit, Fit]) -> bool:
    """Whether held-out rows are predicted worse by a full fit without a trial than by one with it.

    The columns' sizes are those of one-step errors, and those of the full fit may be others: of a
    measured arm (TIAGo) dry friction then took the place of viscous friction that the columns did
    without, and the error of its joint was 2.5 times as large.

    Args:
        proof: what is proved, the trial among it.
        trial: that seemed idle.
        fitted: runs of the fitted half.
        held: the held-out half.
        fits: of all with the full simulation, and of all without the trial.
    """
    acts = proof.bench.acts(trial)
    beside, without = (_left(proof, fitted, held, fit.shift)[acts] for fit in fits)
    return _share(without, beside) > EARNS


def _left(proof: Proof, fitted: Runs, held: Dataset, shift: FloatArray) -> FloatArray:
    """Mean square that a point leaves of each held-out channel, of its level (c,)."""
    rows = held.measured - held.runs.one(carried_point(fitted, held.runs, shift))
    level = proof.bench.regression.level
    return np.asarray(np.square(proof.bench.held.rms(np.asarray(rows, float)) / level))


def _share(without: FloatArray, beside: FloatArray) -> float:
    """By how much squares grow without a cause, of those beside it; no end where they have none."""
    share = float(np.sum(without) - np.sum(beside)) / max(float(np.sum(beside)), 1e-30)
    return share if np.isfinite(share) else np.inf
