"""missing_along: efforts that a measured motion asks for beyond a plant, on the analysis grid."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.signal import savgol_filter

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.law.place import LawForward
from ves_twin.diagnosis.law.screen import values_of
from ves_twin.diagnosis.runs import Runs

WINDOW, DEGREE = 9, 4
"""Of the Savitzky-Golay filter on the analysis grid: 0.09 s at 100 Hz."""

Pieces = list[dict[str, FloatArray]]
"""By recording, name -> (n,)."""


def smooth_channels(runs: Runs, rows: FloatArray) -> Pieces:
    """Channels (rows, c) of each recording, smooth, at the rows of its programme."""
    names = [runs.forward.channels[c].name for c in runs.columns]
    found = []
    for piece, at, programme in zip(runs.slices, runs.times, runs.programmes, strict=True):
        smooth = smoothed(rows[piece])
        curves = CubicSpline(at, smooth, axis=0)(np.clip(programme.time, at[0], at[-1]))
        found.append(dict(zip(names, curves.T, strict=True)))
    return found


def smoothed(rows: FloatArray) -> FloatArray:
    """Rows of the grid (n, ...) behind the filter that positions are seen through."""
    return np.asarray(savgol_filter(rows, WINDOW, DEGREE, axis=0))


def missing_along(
    runs: Runs,
    plant: LawForward,
    motion: Sequence[Mapping[str, FloatArray]],
    shift: FloatArray,
) -> tuple[dict[str, FloatArray], dict[str, FloatArray]] | None:
    """Missing efforts and variables on the grids of all recordings, WINDOW rows off either end.

    Args:
        runs: of the recordings.
        plant: that they are of.
        motion: of `smooth_channels`.
        shift: departures of the plant (coordinates,).

    Returns:
        None where the channels do not tell the motion.
    """
    pieces = []
    for k, values in enumerate(values_of(runs, shift)):
        told = plant.missing(runs.programmes[k], values, motion[k])
        if told is None:
            return None
        rows = np.searchsorted(runs.programmes[k].time, runs.times[k][WINDOW:-WINDOW])
        pieces.append([{name: x[rows] for name, x in part.items()} for part in told])
    efforts, path = (
        {name: np.concatenate([piece[n][name] for piece in pieces]) for name in pieces[0][n]}
        for n in range(2)
    )
    return efforts, path
