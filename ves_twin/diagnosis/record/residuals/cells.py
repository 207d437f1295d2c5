"""Cell: one band, stretch of time or regime of a residual, and how loud it is there."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.record.residuals.noise import Noise
from ves_twin.diagnosis.record.residuals.spectrum import Power, score

BANDS, BLOCKS = 7, 8
"""Bands, equally wide on a logarithmic axis, and stretches, equally long."""

LOWEST = 0.1
"""Upper end of the lowest band [Hz]: one turn of the slowest multisine that is shipped."""

SLOW = 2.5
"""A stretch holds about one draw of the slow noise, which so many sd make likely."""

STILL = 0.05
"""Speeds below this share of the fastest count as standing."""

FEWEST = 8
"""A cell of fewer rows tells nothing."""


@dataclass(frozen=True)
class Cell:
    """How large a residual is in one part of a record.

    Attributes:
        kind: "band", "time", "velocity", "load" or "position".
        label: which part, for instance "0.3-0.8 Hz".
        rms: about the mean of the whole record [SI].
        mean: there, less the mean of the whole record [SI]; zero for a band.
        sigma: rms over the rms of the noise there.
        score: standard normal score of that.
    """

    kind: str
    label: str
    rms: float
    mean: float
    sigma: float
    score: float


def band_edges(period: float) -> FloatArray:
    """Edges of the bands [Hz] (BANDS + 1,), from zero to half the rate."""
    nyquist = 0.5 / period
    low = min(LOWEST, 0.1 * nyquist)
    return np.concatenate([[0.0], np.geomspace(low, 1.001 * nyquist, BANDS)])


def band_label(low: float, high: float) -> str:
    """A band in words."""
    return f"{low:.2g}-{high:.2g} Hz"


def block_edges(time: FloatArray) -> FloatArray:
    """Edges of the stretches [s] (BLOCKS + 1,)."""
    return np.linspace(time[0], time[-1] + 1e-9, BLOCKS + 1)


def bands(power: Power) -> tuple[Cell, ...]:
    """The residual by frequency."""
    edges = band_edges(power.period)
    found = []
    for low, high in pairwise(edges):
        values = power.band(low, high)
        if values is not None:
            rms, sigma, z = values
            found.append(Cell("band", band_label(low, high), rms, 0.0, sigma, z))
    return tuple(found)


def blocks(time: FloatArray, residual: FloatArray, noise: Noise) -> tuple[Cell, ...]:
    """The residual by stretches of time; NaN where nothing was measured."""
    edges = block_edges(time)
    parts = [
        (f"{low:.3g}-{high:.3g} s", (time >= low) & (time < high)) for low, high in pairwise(edges)
    ]
    return _cells("time", parts, residual, noise)


def regimes(
    residual: FloatArray,
    noise: Noise,
    companion: tuple[str, FloatArray] | None,
    load: FloatArray | None,
) -> tuple[Cell, ...]:
    """The residual by sign of velocity, load and position.

    Args:
        residual: rows (n,), NaN where nothing was measured.
        noise: of the column.
        companion: name and values (n,) of the drive column whose velocity and position count.
        load: size of the force on the sensor (n,), halved at its median.
    """
    found: list[Cell] = []
    if companion is not None:
        name, values = companion
        speed = np.gradient(values)
        fast = STILL * float(np.max(np.abs(speed)))
        parts = [
            (f"{name} rising", speed > fast),
            (f"{name} falling", speed < -fast),
            (f"{name} still", np.abs(speed) <= fast),
        ]
        found += _cells("velocity", parts, residual, noise)
        found += _cells("position", _halves(name, values), residual, noise)
    if load is not None and np.isfinite(load).any():
        found += _cells("load", _halves("force on the sensor", load), residual, noise)
    return tuple(found)


def _halves(name: str, values: FloatArray) -> list[tuple[str, NDArray[np.bool_]]]:
    middle = float(np.nanmedian(values))
    return [(f"{name} low", values <= middle), (f"{name} high", values > middle)]


def _cells(
    kind: str,
    parts: list[tuple[str, NDArray[np.bool_]]],
    residual: FloatArray,
    noise: Noise,
) -> tuple[Cell, ...]:
    centred = residual - np.nanmean(residual)
    first = noise.colour[0] if noise.colour else 0.0
    independent = (1.0 - first**2) / (1.0 + first**2)
    usual = noise.sd**2 + (SLOW * noise.slow) ** 2
    found = []
    for label, rows in parts:
        values = centred[rows & np.isfinite(centred)]
        if len(values) >= FEWEST:
            power = float(np.mean(values**2))
            sigma = float(np.sqrt(power / (noise.sd**2 + noise.slow**2)))
            z = score(power / usual, max(len(values) * independent, 1.0))
            mean = float(np.mean(values))
            found.append(Cell(kind, label, float(np.sqrt(power)), mean, sigma, z))
    return tuple(found)
