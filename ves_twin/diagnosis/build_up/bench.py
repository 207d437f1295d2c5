"""Bench: what any subset of causes leaves of held-out rows, sizes fitted on the other half."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ves_twin.core.types import BoolArray, FloatArray, IntArray
from ves_twin.diagnosis.bank.metric import Metric
from ves_twin.diagnosis.build_up.discrepancy import apart, carried
from ves_twin.diagnosis.build_up.paired import Difference, paired
from ves_twin.diagnosis.build_up.regression import Half, LinearFit, Regression
from ves_twin.diagnosis.record.whitening import Whitening

STRAINED = 5.0
"""Sd beyond which a tolerance is not taken to do a cause's work, unless it is that far off beside
all that are in as well: columns of a gain hold what causes do, and 95 % less gain would stand for
all frictions of an axis (EMPS, as it is drafted)."""

ACTS = 0.05
"""Share of its strongest channel's part from which a trial counts as acting on a channel."""


@dataclass(frozen=True)
class Bench:
    """Fits of any subset of trials to the fitted half, told on the held-out half.

    Sizes are of the fitted half; what is drawn anew for each held-out recording is taken off there
    in every subset alike. The discrepancy is held, so that a trial that is taken out does not pass
    for more of it; channels are judged one by one.

    Attributes:
        fit: of all trials of the bench, on the fitted half.
        held: the held-out half.
        regression: of the fitted half.
        memory: whether one-step prediction errors are compared, not plain ones.
        even: whether errors are scaled by their rms, not by the middle.
    """

    fit: LinearFit
    held: Half
    regression: Regression
    memory: bool = True
    even: bool = False

    @cached_property
    def own_colour(self) -> Whitening:
        """The discrepancy of each channel by itself, on the held-out half."""
        return apart(carried(self.fit.whitening, self.held.runs))

    @cached_property
    def _told(self) -> tuple[FloatArray, FloatArray]:
        """Held-out design (rows, c, k) and target (rows, c), whitened; own nuisances taken off."""
        held, width = self.held, len(self.held.runs.columns)
        whitening = self.own_colour
        columns = [held.shared, *held.columns.of(self.fit.chosen)]
        design = whitening.apply(np.concatenate(columns)).T
        scale = np.delete(self.fit.scale, self._own)
        both = np.column_stack([design * scale, whitening.apply(held.target.astype(np.float32))])
        if len(held.own):
            unit = np.repeat(self._unit[None], len(both) // width, axis=0).ravel()
            metric = Metric(whitening.apply(held.own).T / unit[:, None])
            both = metric.project(both / unit[:, None]) * unit[:, None]
        both = both.reshape(-1, width, both.shape[1])
        return both[..., :-1], both[..., -1]

    @cached_property
    def _own(self) -> IntArray:
        """Columns of the fit that belong to single fitted recordings."""
        first = len(self.regression.half.shared)
        return np.arange(first, first + len(self.regression.half.own))

    @cached_property
    def _unit(self) -> FloatArray:
        """Sd of the innovations of each channel on the fitted half (c,)."""
        whitening = apart(self.fit.whitening)
        width = len(self.held.runs.columns)
        inner = whitening.apply(self.fit.residual.astype(np.float32)).reshape(-1, width)
        count = whitening.freedom.reshape(-1, width).sum(axis=0)
        return np.asarray(np.sqrt(np.sum(inner**2, axis=0) / np.maximum(count, 1.0)) + 1e-30)

    @cached_property
    def whole(self) -> BoolArray:
        """Held-out samples that count (rows, c)."""
        return self.own_colour.freedom.reshape(-1, len(self.held.runs.columns)) > 0.0

    @cached_property
    def pieces(self) -> IntArray:
        """Number of the contiguous stretch of each held-out sample (rows,)."""
        any_kept = np.asarray(self.whole.any(axis=1))
        numbers: list[IntArray] = []
        start = 0
        for k, block in enumerate(self.own_colour.times()):
            rows = any_kept[start : start + len(block)]
            steps = np.cumsum(np.append(0, np.abs(np.diff(rows.astype(int)))))
            numbers.append(steps + (numbers[-1][-1] + 1 if k and len(numbers[-1]) else 0))
            start += len(block)
        return np.concatenate(numbers)

    @cached_property
    def places(self) -> dict[int, IntArray]:
        """Columns of each trial in the fit."""
        return self.regression.places(self.fit.chosen)

    def subset(
        self, trials: Sequence[int], of: Sequence[int] | None = None
    ) -> tuple[IntArray, FloatArray]:
        """Columns of a subset with all nuisances, and their amplitudes on the fitted half.

        Args:
            trials: the subset.
            of: a larger one beside which amplitudes are fitted; the subset itself if None.
        """
        first = self.regression.half.fixed
        parts = [np.arange(first), *(self.places[n] for n in (trials if of is None else of))]
        at = np.concatenate(parts).astype(int)
        shares = self._held(at, first)
        kept = np.concatenate([np.arange(first), *(self.places[n] for n in trials)]).astype(int)
        amplitude = np.zeros(len(self.fit.scale))
        amplitude[at] = shares
        return kept, amplitude[kept]

    def _held(self, at: IntArray, nuisances: int) -> FloatArray:
        """Amplitudes of columns, nuisances no farther off than in the bench's fit, or STRAINED."""
        limit = np.full(len(at), np.inf)
        limit[:nuisances] = np.maximum(STRAINED, np.abs(self.fit.shares[:nuisances]))
        matrix, slope = self.fit.hessian[np.ix_(at, at)], self.fit.gradient[at]
        shares, free = np.zeros(len(at)), np.ones(len(at), bool)
        while True:
            gradient = slope[free] - matrix[np.ix_(free, ~free)] @ shares[~free]
            shares[free] = np.linalg.solve(matrix[np.ix_(free, free)], gradient)
            beyond = free & (np.abs(shares) > limit)
            if not beyond.any():
                return shares
            shares[beyond] = np.sign(shares[beyond]) * limit[beyond]
            free &= ~beyond

    def innovations(self, trials: Sequence[int], of: Sequence[int] | None = None) -> FloatArray:
        """What a subset leaves of the held-out rows (rows, c); arguments as of `subset`."""
        at, shares = self.subset(trials, of)
        kept = ~np.isin(at, self._own)
        every = np.setdiff1d(np.arange(len(self.fit.scale)), self._own)
        design, target = self._told
        where = np.searchsorted(every, at[kept])
        return np.asarray(target - design[..., where] @ shares[kept])

    def residual(self, trials: Sequence[int]) -> FloatArray:
        """What a subset leaves of the held-out channels, in their units, own nuisances unfitted."""
        at, shares = self.subset(trials)
        amplitudes = np.zeros(len(self.fit.scale))
        amplitudes[at] = shares
        amplitudes = np.delete(amplitudes * self.fit.scale, self._own)
        columns = [self.held.shared, *self.held.columns.of(self.fit.chosen)]
        return self.held.target - np.tensordot(amplitudes, np.concatenate(columns), axes=1)

    def bare(self, trials: Sequence[int]) -> FloatArray:
        """Mean square that a subset leaves of each held-out channel, of its level (c,)."""
        return np.asarray(np.square(self.held.rms(self.residual(trials)) / self.regression.level))

    def scale(self, trials: Sequence[int]) -> FloatArray:
        """Scale of the innovations that a subset leaves (c,): robust, or their rms."""
        left = np.where(self.whole, self.innovations(trials), np.nan)
        if self.even:
            return np.asarray(np.sqrt(np.nanmean(np.square(left), axis=0)) + 1e-30)
        return np.asarray(np.nanmedian(np.abs(left), axis=0) / 0.6745 + 1e-30)

    def acts(self, trial: int) -> BoolArray:
        """Channels on which a trial acts (c,)."""
        half = self.held
        parts = [half.rms(column) / self.regression.level for column in half.columns[trial]]
        size = np.sqrt(np.mean(np.square(parts), axis=0))
        return np.asarray(size > ACTS * np.max(size))

    def impossible(self, trial: int) -> bool:
        """Whether a trial is fitted with a sign that no machine has, or far out of its range."""
        return self.regression.impossible(trial, self.fit.shares[self.places[trial]])

    def compared(self, trial: int, without: FloatArray, beside: FloatArray) -> Difference:
        """Paired test of losses (rows, c) on the channels where a trial acts."""
        counted = self.whole & self.acts(trial)
        rows = counted.any(axis=1)
        difference = np.where(counted, without - beside, 0.0).sum(axis=1)
        return paired(difference[rows], self.pieces[rows])
