"""forecast: whether causes that belong to a stretch of time hold after its end."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.recording import POSES, Recording
from ves_twin.core.workers import Workers
from ves_twin.diagnosis.bank.linearise import linearise
from ves_twin.diagnosis.fit.refine import Fit, refine
from ves_twin.diagnosis.model.forward import Forward
from ves_twin.diagnosis.model.grid import AnalysisGrid
from ves_twin.diagnosis.record.evidence import Evidence
from ves_twin.diagnosis.record.preprocess import FEWEST_POSES, FEWEST_ROWS, preprocess
from ves_twin.diagnosis.record.whitening import whitening_of
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.unseen.gain import Gain
from ves_twin.diagnosis.unseen.held_out_gain import DivergedError, held_out_gain

LEARNT = 0.7
"""Share of the time that is fitted; the rest is forecast."""


def forecast(
    forward: Forward,
    recordings: Sequence[Recording],
    fit: Fit,
    settings: Settings,
    standstill: Recording | None = None,
    workers: Workers | None = None,
) -> Gain | None:
    """Gain of a fit's causes on the last part of the time, fitted to what came before it.

    Random or alternating parts of a record tell whether a drift fills in; only this tells whether
    it can be carried on.

    Args:
        forward: the plant, tuned to its rig where there is a baseline.
        recordings: all of them, fitted and held out.
        fit: whose causes are tried, each begun at its sizes.
        settings: how sure.
        standstill: tells the noise; the declared one is taken without it.
        workers: for predictions; this process if None.

    Returns:
        The gain; None where one of the two parts is too short, or has too many holes.
    """
    ends = [float(r.time[0]) for r in recordings], [float(r.time[-1]) for r in recordings]
    split = min(ends[0]) + LEARNT * (max(ends[1]) - min(ends[0]))
    rate = settings.rate
    before = [r for piece in recordings for r in _part(piece, -np.inf, split, rate)]
    after = [r for piece in recordings for r in _part(piece, split, np.inf, rate)]
    if not before or not after:
        return None
    try:
        early, late = (preprocess(forward, part, workers, rate) for part in (before, after))
        noise, whitening = (whitening_of(part.runs, standstill) for part in (early, late))
    except InvalidInputError:  # all of them together could be looked at, so it is the holes
        return None
    base = linearise(early.runs, early.runs.origin)
    evidence = Evidence(early.runs, early.measured, noise)
    plain = refine(evidence, (), early.runs.origin, base, settings.rounds)
    shift = plain.shift.copy()
    free = fit.active[: len(fit.sizes)]
    names = [axis.parameter.name for axis in early.runs.coordinates]
    for i, size in zip(free, fit.sizes, strict=True):
        shift[names.index(fit.local.runs.coordinates[i].parameter.name)] = size
    caused = refine(evidence, fit.causes, shift, base, settings.rounds)
    told = (plain, caused, settings.confidence, settings.seed)
    try:
        return held_out_gain(late.runs, late.measured, whitening, *told)
    except DivergedError:
        return None


def _part(recording: Recording, start: float, stop: float, rate: float) -> list[Recording]:
    """The rows between two times, if they are enough on the grid to be looked at."""
    time = recording.time[(recording.time >= start) & (recording.time < stop)]
    if recording.info.log == POSES:
        enough = len(time) >= FEWEST_POSES
    elif len(time) < FEWEST_ROWS:
        enough = False
    else:
        grid = AnalysisGrid.of(float(time[-1] - time[0]) / (len(time) - 1), rate)
        reach = len(grid.taps) - 1
        enough = len(time) > reach and len(grid.times(time)) >= FEWEST_ROWS
    return [recording.window(start, stop)] if enough else []
