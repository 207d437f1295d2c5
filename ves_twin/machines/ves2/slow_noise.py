"""slow_modes: the sensor's slow noise in a record, as a few shapes with unit normal weights."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from ves_twin.core.types import FloatArray

MODES = 7
"""Shapes that are kept. A record of 10 s at T = 20 s has the 7th at 0.05 of the slow sd: a third of
what the sensor's fast noise leaves of such a shape."""

GRID = 160
"""Points on which the covariance is taken apart."""


def slow_modes(time: FloatArray, correlation_time: float, zeroed: float = 0.5) -> FloatArray:
    """Karhunen-Loeve modes of a Gauss-Markov noise since the sensor was zeroed.

    x has covariance exp(-|t - s| / T). Zeroing takes its value at -t0 away, so a record holds
    x(t) - x(-t0) with covariance e(t - s) - e(t + t0) - e(s + t0) + 1; its eigenvectors, scaled by
    the root of their eigenvalues, have independent unit normal weights.

    Args:
        time: of the rows, since the start of the run [s] (n,).
        correlation_time: T [s].
        zeroed: t0, how long before the start the zero holds [s].

    Returns:
        Shapes for a slow noise of sd 1 (n, MODES).

    Source: K. Karhunen 1947, M. Loeve 1948.
    """
    length = float(time[-1] - time[0])
    t, shapes = _loudest(length, correlation_time, zeroed)
    return np.stack([np.interp(time - time[0], t, shape) for shape in shapes.T], axis=1)


@lru_cache(maxsize=16)
def _loudest(
    length: float, correlation_time: float, zeroed: float
) -> tuple[FloatArray, FloatArray]:
    """Times from the first row on (GRID,), and the shapes there (GRID, MODES).

    Kept, since each trial of a search asks for those of one length again.
    """
    t = np.linspace(0.0, length, GRID)
    since = np.exp(-(t + zeroed) / correlation_time)
    covariance = np.exp(-np.abs(t[:, None] - t) / correlation_time) - since[:, None] - since + 1.0
    values, vectors = np.linalg.eigh(covariance)
    loudest = np.argsort(-values)[:MODES]
    return t, vectors[:, loudest] * np.sqrt(np.maximum(values[loudest], 0.0))
