"""Paired test: does a model predict held-out rows better, beyond what stretches of time vary by?"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.stats import t as student

from ves_twin.core.types import FloatArray, IntArray

DEGREES = 5.0
"""Of Student's loss 3 ln(1 + (e / s)^2 / 5): a reversal or a spike counts by its logarithm. With
squared loss the coupling of TX40 was lost to four reversals."""

MEMORY = 5.0
"""Integral times of the difference that a block spans, so that blocks are nearly independent."""

SHORTEST = 1.0 / 40.0
LONGEST = 1.0 / 12.0
"""Limits of a block, as shares of all held-out rows: with shorter ones a second gap of the damper
was proved at 1e-24, longer ones leave too few for a test."""


@dataclass(frozen=True)
class Difference:
    """What a paired test says.

    Attributes:
        p: probability of a mean difference this large where there is none, one-sided.
        total: sum of the differences.
        blocks: stretches of time that were compared.
    """

    p: float
    total: float
    blocks: int


def loss(innovations: FloatArray, scale: FloatArray) -> FloatArray:
    """Student's log loss of innovations (rows, c), with a robust scale of each channel (c,)."""
    squares = np.square(innovations / scale) / DEGREES
    return np.asarray(0.5 * (DEGREES + 1.0) * np.log1p(squares))


def paired(difference: FloatArray, piece: IntArray) -> Difference:
    """One-sided t test of the mean over blocks that are longer than the difference remembers.

    Args:
        difference: loss without less loss with, row by row (n,).
        piece: number of the contiguous stretch that each row belongs to (n,).
    """
    if not len(difference):
        return Difference(1.0, 0.0, 0)
    numbers = _blocks(piece, _length(difference, piece))
    sums = np.bincount(numbers, difference)
    sums = sums[np.bincount(numbers) > 0]
    count, total = len(sums), float(np.sum(difference))
    if count < 3:
        return Difference(1.0, total, count)
    spread = np.sqrt(count / (count - 1.0) * np.sum(np.square(sums - np.mean(sums))))
    p = float(student.sf(total / max(float(spread), 1e-12), count - 1))
    return Difference(p, total, count)


def _length(difference: FloatArray, piece: IntArray) -> int:
    """Rows of a block: MEMORY integral times of the difference, within the limits."""
    centred = difference - np.mean(difference)
    spectrum = np.abs(np.fft.rfft(centred, 2 * len(centred))) ** 2
    memory = np.fft.irfft(spectrum)[: len(centred)]
    memory = memory / max(float(memory[0]), 1e-30)
    ends = np.flatnonzero(memory < 0.05)
    stop = int(ends[0]) if len(ends) else len(memory)
    rows = MEMORY * (0.5 + float(np.sum(memory[1:stop])))
    return max(1, round(float(np.clip(rows, SHORTEST * len(piece), LONGEST * len(piece)))))


def _blocks(piece: IntArray, length: int) -> IntArray:
    """Number of the block of each row: equal parts of each stretch, none across a gap."""
    numbers, first = np.zeros(len(piece), np.int64), 0
    for name in np.unique(piece):
        rows = np.flatnonzero(piece == name)
        parts = max(1, len(rows) // length)
        numbers[rows] = first + np.minimum(np.arange(len(rows)) // length, parts - 1)
        first += parts
    return numbers
