"""Adequacy: is what is left noise, in every channel, band and stretch of time?"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.stats import norm

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.record.residuals.spectrum import score
from ves_twin.diagnosis.record.whitening import Whitening

BANDS = 12
"""Frequency bands, geometric from two lines up."""

BLOCKS = 8
"""Stretches of time."""


FEWEST = 8
"""Samples of a stretch of time, most of it a hole, below which it is not judged."""


@dataclass(frozen=True)
class EnergyCell:
    """Energy of a whitened residual in one channel and band, or channel and stretch of time.

    Attributes:
        recording: which recording, from 0.
        channel: which whitened channel, from 0.
        kind: "band" or "time".
        low, high: ends of the band [Hz] or of the stretch [s].
        energy: sum of squares; of unit white noise it is chi^2 with `freedom` degrees of freedom.
        freedom: real numbers in the cell.
    """

    recording: int
    channel: int
    kind: str
    low: float
    high: float
    energy: float
    freedom: int

    def score(self, allowed: float = 0.0) -> float:
        """Standard-normal score of the energy less an allowance; unit noise is known."""
        ratio = max(self.energy - allowed, 0.0) / self.freedom
        return score(ratio, self.freedom, known=0.0)


def cells(whitening: Whitening, z: FloatArray) -> list[EnergyCell]:
    """All cells of a whitened residual (samples,)."""
    found = []
    kept = whitening.blocks(whitening.freedom)
    for k, (block, time) in enumerate(zip(whitening.blocks(z), whitening.times(), strict=True)):
        rows = len(block)
        share = np.mean(kept[k], axis=0)
        spectrum = 2.0 * np.abs(np.fft.rfft(block, axis=0)) ** 2 / rows
        frequency = np.fft.rfftfreq(rows, whitening.runs.grids[k].step)
        last = (rows - 1) // 2  # the line at the Nyquist rate has half the freedom
        edges = np.unique(np.geomspace(2, last + 1, BANDS).astype(int))
        edges = np.concatenate([[1], edges])
        stretches = np.unique(np.linspace(0, rows, BLOCKS + 1).astype(int))
        for c in range(block.shape[1]):
            for a, b in pairwise(edges):
                energy = float(np.sum(spectrum[a:b, c]) / share[c])
                ends = float(frequency[a]), float(frequency[b - 1])
                found.append(EnergyCell(k, c, "band", *ends, energy, 2 * int(b - a)))
            for a, b in pairwise(stretches):
                energy = float(np.sum(block[a:b, c] ** 2))
                ends = float(time[a]), float(time[b - 1])
                count = int(np.sum(kept[k][a:b, c]))
                if count >= FEWEST:
                    found.append(EnergyCell(k, c, "time", *ends, energy, count))
    return found


def misfit(
    found: list[EnergyCell], before: list[EnergyCell] | None = None, model_error: float = 0.0
) -> float:
    """The largest score of all cells.

    Args:
        found: cells of what is left.
        before: cells before a cause was fitted.
        model_error: relative error that the change due to that cause may have; the square of it
            times what the cause took away is allowed to stay in each cell.
    """
    if before is None or model_error == 0.0:
        return max(cell.score() for cell in found)
    return max(
        cell.score(model_error**2 * max(old.energy - old.freedom, 0.0))
        for cell, old in zip(found, before, strict=True)
    )


def misfit_floor(count: int, alpha: float) -> float:
    """Score that white noise passes with probability alpha, of `count` independent cells."""
    return float(norm.isf(alpha / count))
