"""Companions: how much of a residual goes along with each column of the drive, or its rate."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ves_twin.core.types import ComplexArray, FloatArray
from ves_twin.core.without_line import without_line

CLEAR = 1.5
"""A coherence so many times what chance gave is one."""

PIECES = 15
"""Overlapping pieces of a record: half of each with the next."""

SHIFTS = range(3, PIECES - 3)
"""Half pieces by which a record is shifted to tell what chance gives."""

SHORTEST = 16
"""Rows of a piece below which a spectrum means nothing."""

RATE = "the rate of "
"""Before the name of a column whose rate it is: a slow column is a curve within a piece, which
passes for any other, and friction follows its rate (an arm's wrist: 56 % with another joint)."""


@dataclass(frozen=True)
class Coherence:
    """Share of a residual's power that one column of the drive, or its rate, explains linearly.

    Attributes:
        value: largest over these columns: of a filter within pieces, weighted by the residual's
            power, or of a factor over the whole record, lines taken off.
        chance: largest that the same figure reaches with the residual shifted in time.
        column: the column of the drive, after RATE if it is its rate.
    """

    value: float
    chance: float
    column: str

    @property
    def told(self) -> bool:
        """Whether it is clearly more than chance."""
        return self.value > CLEAR * self.chance


class Companions:
    """Spectra of the pieces of every drive column that moves, and of its rate.

    Args:
        names: columns of the drive.
        drive: their values (n, columns).
    """

    def __init__(self, names: tuple[str, ...], drive: FloatArray) -> None:
        moving = np.ptp(drive, axis=0) > 0.0
        own = tuple(np.array(names)[moving].tolist())
        self._length = 2 * (len(drive) // (PIECES + 1))
        self._told = bool(moving.any()) and self._length >= SHORTEST
        every = _with_rates(drive[:, moving]) if self._told else np.zeros((len(drive), 0))
        self._names = (*own, *(RATE + name for name in own)) if self._told else ()
        self._pieces = self._spectra(every) if self._told else np.zeros((0, 0, 0), complex)
        self._every: dict[str, FloatArray] = dict(zip(self._names, every.T, strict=True))
        about = without_line(every)
        self._whole = about / np.maximum(np.linalg.norm(about, axis=0), 1e-300)

    def rows(self, name: str) -> FloatArray:
        """Of a column that a coherence names (n,)."""
        return self._every[name]

    def of(self, residual: FloatArray) -> Coherence | None:
        """The drive column that a residual (n,) goes along with most; None if nothing moves."""
        if not self._told:
            return None
        pieces = self._spectra(residual[:, None])
        values = self._together(residual, pieces, 0)
        best = int(np.argmax(values))
        chance = max(float(self._together(residual, pieces, k).max()) for k in SHIFTS)
        return Coherence(float(values[best]), chance, self._names[best])

    def _spectra(self, rows: FloatArray) -> ComplexArray:
        """Of each piece, its line removed (pieces, f, columns)."""
        half = self._length // 2
        window = np.hanning(self._length)[:, None]
        line = np.vander(np.linspace(-1.0, 1.0, self._length), 2)
        parts = []
        for k in range(PIECES):
            piece = rows[k * half : k * half + self._length]
            piece = piece - line @ np.linalg.lstsq(line, piece, rcond=None)[0]
            parts.append(np.fft.rfft(piece * window, axis=0)[1:])
        return np.asarray(parts)

    def _together(self, residual: FloatArray, pieces: ComplexArray, turn: int) -> FloatArray:
        """What each column explains: as a filter of it within pieces, or by a factor in all."""
        rows = np.roll(without_line(residual), turn * self._length // 2)
        factor = np.square(rows @ self._whole / max(float(np.linalg.norm(rows)), 1e-300))
        return np.asarray(np.maximum(self._shares(pieces, turn), factor))

    def _shares(self, residual: ComplexArray, turn: int) -> FloatArray:
        drive = np.roll(self._pieces, turn, axis=0)
        cross = np.abs(np.mean(residual * drive.conj(), axis=0)) ** 2
        power = np.mean(np.abs(residual) ** 2, axis=0)
        fed = np.mean(np.abs(drive) ** 2, axis=0)
        explained = cross / np.maximum(fed, 1e-9 * fed.max(axis=0))
        return np.asarray(explained.sum(axis=0) / max(float(power.sum()), 1e-300))


def _with_rates(drive: FloatArray) -> FloatArray:
    """Columns (n, k), and their changes from row to row behind them (n, 2 k)."""
    return np.column_stack([drive, np.gradient(drive, axis=0)])
