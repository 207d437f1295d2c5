"""inverse_start: causes that the measured motion itself asks for, where simulations are far off."""

from __future__ import annotations

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.build_up.builder import Builder, Start, present_in
from ves_twin.diagnosis.build_up.halves import carried_point
from ves_twin.diagnosis.build_up.in_full import in_full
from ves_twin.diagnosis.build_up.plain_selector import PlainSelector
from ves_twin.diagnosis.fit.fit_context import FitContext
from ves_twin.diagnosis.fit.refine import Fit
from ves_twin.diagnosis.record.by_motion import by_motion
from ves_twin.diagnosis.record.preprocess import Dataset


def inverse_start(desk: FitContext, fitted: Dataset, known: Fit) -> Start | None:
    """Causes and tolerances by inverse dynamics, as a point to build up from.

    Over seconds of a lively machine what a cause changes in a simulation holds near that simulation
    alone, which is far from what was measured: what is chosen there is chance (a pendubot in open
    loop). The efforts that the measured motion asks for are linear in most causes. They are noisy,
    and a cause in them is no proof; simulations from there are near enough to choose, fit and prove
    by. Of the fitted half alone.

    Args:
        desk: the record before any cause.
        fitted: recordings that sizes come from.
        known: a fit that simulations from the start must be nearer than to be worth it.

    Returns:
        None where they are not, or the motion is not measured.
    """
    seen, budget = by_motion(fitted, as_nominal=True), fitted.runs.budget
    if seen is None or budget.skips("a start by the measured motion"):
        return None
    desk.progress(0.0, "what the measured motion asks for")
    builder, origin = Builder(desk, seen, seen), seen.runs.origin
    halves = builder.halves(origin, ())
    chosen = PlainSelector(halves.regression).run()
    halves, point, chosen = builder.settled(PlainSelector, halves, chosen, origin)
    evidence = builder.evidence(halves.regression.fit(chosen).residual, memory=False)
    fit = in_full(halves.regression, chosen, point, evidence)
    there = carried_point(known.local.runs, fitted.runs, known.shift)
    if not _left(fitted, fit.shift) < _left(fitted, there):
        return None
    return Start(fit.shift, present_in([halves.regression.trials[n] for n in chosen], fit))


def _left(fitted: Dataset, point: FloatArray) -> float:
    """Mean of the logarithm of the rms errors of all channels at a point; nan where it fails."""
    runs = fitted.runs
    left = np.where(runs.kept, fitted.measured - runs.one(point), 0.0)
    return float(np.mean(np.log(np.sqrt(np.mean(np.square(left, dtype=float), axis=0)) + 1e-30)))
