"""memory: rows over which a column remembers itself, and independent_rows of a residual."""

from __future__ import annotations

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.record.runs import Runs

GONE = 0.05
"""Autocorrelation at which memory counts as gone."""


def memory(column: FloatArray) -> float:
    """Integral time: 1/2 and the autocorrelation up to where it is gone, in rows."""
    centred = column - column.mean()
    power = np.abs(np.fft.rfft(centred, 2 * len(centred))) ** 2
    covariance = np.fft.irfft(power)[: len(centred)]
    covariance = covariance / max(float(covariance[0]), 1e-30)
    ends = np.flatnonzero(covariance < GONE)
    stop = int(ends[0]) if len(ends) else len(covariance)
    return float(0.5 + np.sum(covariance[1:stop]))


def independent_rows(runs: Runs, residual: FloatArray) -> FloatArray:
    """Rows of each channel over twice their memory (c,): how many of them count by themselves.

    Args:
        runs: whose rows these are.
        residual: (rows, c).
    """
    found, kept = np.zeros(residual.shape[1]), runs.kept
    for piece in runs.slices:
        for c in range(len(found)):
            column = residual[piece, c][kept[piece, c]]
            if len(column) > 1:
                found[c] += len(column) / max(2.0 * memory(column), 1.0)
    return found
