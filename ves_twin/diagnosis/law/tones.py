"""tone_laws: a line in time that a column shows, and a ripple along a joint's position."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.law.candidate import Closed
from ves_twin.diagnosis.law.fit_law import LawFit, fit_law
from ves_twin.diagnosis.law.forms import TONE
from ves_twin.diagnosis.law.screen import columns_about
from ves_twin.diagnosis.law.sizes import Sizes
from ves_twin.diagnosis.law.smoothness import projected
from ves_twin.diagnosis.model.law_forward import LawPlace, Variable
from ves_twin.diagnosis.record.evidence import Evidence
from ves_twin.diagnosis.record.runs import Progress, silent
from ves_twin.effects.law import LawKind

RIPPLES = (1.5, 20.0)
"""Periods of a ripple in the range seen: fewer are a bend, more are not resolved in time."""

DENSITY = 3
"""Frequencies that are scanned for each period in the range."""

LOWEST = 4.0
"""Periods of a line in the recording at least: slower ones are a drift."""

RIDGE = 1e-9
"""Share of a pair of columns that keeps their squares apart from zero."""

CLOSE = 40.0
"""Chi^2 behind the best tone within which others are fitted."""

LEAST_SHARE = 0.8
"""The same as a share, while the fit without a law is far off."""

LINES = 3
"""Peaks of a spectrum that are tried as lines."""


def tone_laws(
    evidence: Evidence,
    about: LawFit,
    places: Sequence[LawPlace],
    ends: Mapping[str, tuple[float, float]],
    least: float,
    progress: Progress = silent,
) -> list[LawFit]:
    """The best tone: along time for columns, along the joint's own position; and its equals.

    Args:
        evidence: what was measured.
        about: fit without a law.
        places: where tones are looked for.
        ends: of the variables.
        least: nats below which none is fitted, by the linearisation.
        progress: told how far it is.
    """
    scanned = []
    for n, place in enumerate(places):
        progress(n / len(places), "tones")
        for variable in _carriers(place, ends):
            low, high = ends[variable.name]
            if variable.what == "time":
                tried = _lines(evidence, about, place, high - low)
            else:
                periods = np.arange(*RIPPLES, 1.0 / DENSITY)
                tried = np.asarray(2.0 * np.pi * periods / (high - low))
            if len(tried):
                tone = Closed(place, (variable,), (TONE,), ((1.0, 0.0),), (low, high))
                scanned.append(_best(evidence, about, tone, tried))
    best = max((fall for fall, _, _ in scanned), default=0.0)
    least = max(best - CLOSE, LEAST_SHARE * best, 2.0 * least)
    kept = [(tone, numbers) for fall, tone, numbers in scanned if fall > least]
    return [fit_law(evidence, tone, about.fit, numbers) for tone, numbers in kept]


def _carriers(place: LawPlace, ends: Mapping[str, tuple[float, float]]) -> list[Variable]:
    own = [v for v in place.variables if v.what == "position" and v.name in ends][:1]
    if place.kind is LawKind.READING:
        own += [v for v in place.variables if v.what == "time"]
    return [v for v in own if ends[v.name][1] > ends[v.name][0]]


def _lines(evidence: Evidence, about: LawFit, place: LawPlace, duration: float) -> FloatArray:
    """Angular frequencies [rad/s] of the highest peaks of what is left in a column."""
    runs, whitening = evidence.runs, evidence.whitening
    names = [runs.forward.channels[c].name for c in runs.columns]
    if place.name not in names:
        return np.zeros(0)
    block, grid = whitening.blocks(about.fit.residual)[0], runs.grids[0]
    power = np.abs(np.fft.rfft(block[:, names.index(place.name)], 4 * len(block))) ** 2
    frequency = np.fft.rfftfreq(4 * len(block), grid.step)
    power[frequency < LOWEST / duration] = 0.0
    peaks = np.flatnonzero((power[1:-1] > power[:-2]) & (power[1:-1] >= power[2:])) + 1
    best = peaks[np.argsort(-power[peaks])[:LINES]]
    return np.asarray(2.0 * np.pi * frequency[best])


def _best(
    evidence: Evidence, about: LawFit, tone: Closed, tried: FloatArray
) -> tuple[float, Closed, FloatArray]:
    """Fall of chi^2 by the best frequency, the tone there, and its size, frequency and phase."""
    pairs = [
        replace(tone, inner=((w, phase),)) for w in tried.tolist() for phase in (0.0, 0.5 * np.pi)
    ]
    columns = columns_about(evidence, Sizes(tone.place, tone.of, tuple(pairs)), about)
    z = about.fit.residual + about.jacobian @ about.point
    gram, slope = projected(columns, about.jacobian, z, about.temper)
    falls, sizes = [], []
    for n in range(0, len(pairs), 2):
        own = gram[n : n + 2, n : n + 2]
        ridged = own + RIDGE * np.trace(own) * np.eye(2)
        # a tone that changes nothing has no size
        sizes.append(np.linalg.lstsq(ridged, slope[n : n + 2], rcond=None)[0])
        falls.append(float(slope[n : n + 2] @ sizes[-1]))
    best = int(np.argmax(falls))
    w, phase = float(tried[best]), float(np.arctan2(sizes[best][1], sizes[best][0]))
    numbers = np.array([float(np.hypot(*sizes[best])), w, phase])
    return falls[best], replace(tone, inner=((w, phase),)), numbers
