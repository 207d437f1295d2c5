"""Lacking: what a model always gets wrong on a rig, and how it may act on another motion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.signal import butter, sosfiltfilt

from ves_twin.core.types import FloatArray, SingleArray
from ves_twin.diagnosis.model.forward import Excitation, Parameter
from ves_twin.diagnosis.record.runs import Runs

CHANGE = 0.2
"""Share by which it may grow, or turn, between two recordings: a fault moves the rig otherwise."""

SMOOTH = 10.0
"""Frequency above which what stays of a recording is taken as noise [Hz]."""

BANDS = 3
"""Parts of equal energy, by frequency, that change by themselves."""

PARAMETERS = tuple(
    Parameter(f"lacking.{kind}.{band + 1}", "1", 0.0, -3.0, 3.0, sd=CHANGE, additive=True)
    for band in range(BANDS)
    for kind in ("growth", "turn")
)
"""Growth of each band, and a turn in phase: the derivative at the same rms."""


@dataclass(frozen=True)
class Lacking:
    """Traces of lacking physics on one programme.

    Attributes:
        programme: its identity.
        traces: of each of PARAMETERS at 1: all channels of the forward at the programme's rows
            (parameters, n, channels).
    """

    programme: str
    traces: FloatArray

    @staticmethod
    def of(runs: Runs, usual: SingleArray) -> tuple[Lacking, ...]:
        """From what stays of recordings of a rig in order.

        Args:
            runs: of the tuned model.
            usual: measured less predicted on the grid (rows, c).
        """
        found = []
        parts = zip(runs.programmes, runs.slices, runs.grids, runs.times, strict=True)
        for programme, rows, grid, time in parts:
            piece = np.asarray(usual[rows], float)
            bands = [piece] + [0.0 * piece] * (BANDS - 1)
            if not programme.poses:
                bands = _bands(piece, grid.step)
            traces = []
            for band in bands:
                slope = np.zeros_like(band) if programme.poses else np.gradient(band, axis=0)
                rms = np.sqrt(np.mean(slope**2, axis=0))
                turn = slope * np.sqrt(np.mean(band**2, axis=0)) / np.maximum(rms, 1e-30)
                traces += [_spread(runs, programme, time, trace) for trace in (band, turn)]
            found.append(Lacking(programme.identity, np.array(traces)))
        return tuple(found)


def _bands(piece: FloatArray, step: float) -> list[FloatArray]:
    """Parts of equal energy below SMOOTH (rows, c) each; what is above is left out."""
    nyquist = 0.5 / step
    ceiling = min(SMOOTH, 0.9 * nyquist)
    scaled = piece / np.maximum(np.std(piece, axis=0), 1e-30)
    power = np.sum(np.abs(np.fft.rfft(scaled, axis=0)) ** 2, axis=1)
    frequency = np.fft.rfftfreq(len(piece), step)
    power[frequency > ceiling] = 0.0
    shares = np.cumsum(power) / max(float(np.sum(power)), 1e-30)
    goals = (np.arange(BANDS - 1) + 1.0) / BANDS
    ends = frequency[np.minimum(np.searchsorted(shares, goals), len(frequency) - 1)]
    lower, found = np.zeros_like(piece), []
    for end in (*ends, ceiling):
        corner = float(np.clip(end / nyquist, 1e-3, 0.95))
        upto = sosfiltfilt(butter(2, corner, output="sos"), piece, axis=0)
        found.append(upto - lower)
        lower = upto
    return found


def _spread(runs: Runs, programme: Excitation, time: FloatArray, piece: FloatArray) -> FloatArray:
    """From the grid to all channels at the programme's rows; 0 in what is not recorded."""
    found = np.zeros((len(programme.time), len(runs.forward.channels)))
    for c, column in zip(runs.columns, piece.T, strict=True):
        found[:, c] = np.interp(programme.time, time, column)
    return found
