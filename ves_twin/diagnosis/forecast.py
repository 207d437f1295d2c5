"""forecast: whether causes that belong to a stretch of time hold after its end."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ves_twin.diagnosis.evidence import Evidence
from ves_twin.diagnosis.forward import Forward
from ves_twin.diagnosis.gain import Gain, held_out_gain
from ves_twin.diagnosis.linearise import linearise
from ves_twin.diagnosis.observe import FEWEST_POSES, FEWEST_ROWS, observe
from ves_twin.diagnosis.refine import Fit, refine
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.whitening import whitening_declared
from ves_twin.recording.recording import POSES, Recording

LEARNT = 0.7
"""Share of the time that is fitted; the rest is forecast."""


def forecast(
    forward: Forward, recordings: Sequence[Recording], fit: Fit, settings: Settings
) -> Gain | None:
    """Gain of a fit's causes on the last part of the time, fitted to what came before it.

    Random or alternating parts of a record tell whether a drift fills in; only this tells whether
    it can be carried on.

    Args:
        forward: the plant.
        recordings: all of them, fitted and held out.
        fit: whose causes are tried, each begun at its sizes.
        settings: how sure.

    Returns:
        The gain; None where one of the two parts is too short.
    """
    ends = [float(r.time[0]) for r in recordings], [float(r.time[-1]) for r in recordings]
    split = min(ends[0]) + LEARNT * (max(ends[1]) - min(ends[0]))
    before = [r for piece in recordings for r in _part(piece, -np.inf, split)]
    after = [r for piece in recordings for r in _part(piece, split, np.inf)]
    if not before or not after:
        return None
    early = observe(forward, before, rate=settings.rate)
    late = observe(forward, after, rate=settings.rate)
    base = linearise(early.runs, early.runs.origin)
    evidence = Evidence(early.runs, early.measured, whitening_declared(early.runs))
    plain = refine(evidence, (), early.runs.origin, base, settings.rounds)
    shift = plain.shift.copy()
    free = fit.active[: len(fit.sizes)]
    names = [axis.parameter.name for axis in early.runs.coordinates]
    for i, size in zip(free, fit.sizes, strict=True):
        shift[names.index(fit.local.runs.coordinates[i].parameter.name)] = size
    caused = refine(evidence, fit.causes, shift, base, settings.rounds)
    whitening = whitening_declared(late.runs)
    return held_out_gain(
        late.runs, late.measured, whitening, plain, caused, settings.confidence, settings.seed
    )


def _part(recording: Recording, start: float, stop: float) -> list[Recording]:
    """The rows between two times, if they are enough to be looked at."""
    rows = (recording.time >= start) & (recording.time < stop)
    fewest = FEWEST_POSES if recording.info.log == POSES else 2 * FEWEST_ROWS
    if np.count_nonzero(rows) < fewest:
        return []
    return [recording.window(start, stop)]
