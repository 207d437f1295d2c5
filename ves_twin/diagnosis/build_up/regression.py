"""Regression: sizes of any set of trials against noise and model error, on one half of the data."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from ves_twin.core.types import BoolArray, FloatArray, IntArray, SingleArray
from ves_twin.diagnosis.bank.inner import inner
from ves_twin.diagnosis.build_up.discrepancy import discrepancy, usual_shrinkage
from ves_twin.diagnosis.build_up.eliminated import Eliminated
from ves_twin.diagnosis.build_up.gains import Gains
from ves_twin.diagnosis.build_up.products import Products
from ves_twin.diagnosis.build_up.trial_columns import TrialColumns
from ves_twin.diagnosis.build_up.trials import Trial
from ves_twin.diagnosis.record.runs import Runs
from ves_twin.diagnosis.record.whitening import Whitening

WIDE = 5.0
"""Prior sd of a cause's contribution, in rms of everything that is to be explained: wide enough to
leave sizes alone, narrow enough to keep collinear columns apart from overflow."""

ROUNDS = 3
"""Times that the discrepancy is learnt anew from what a fit leaves; it moves sizes by less than a
hundredth of their sd then (TX40)."""

BEYOND = 1.5
"""Times the end of its range at which a linear size is held to be none of that cause's: columns of
finite sizes, and what is not chosen yet, may move it past the end a little. 1.5 was chosen before
it was tried: a gain of a drive's torque, five times as large as its range allows, stood for the
inertia and friction that a bench's model lacks. Held to bent columns as well it lost the valve of
the excavator (0.175 cm in place of 0.082)."""

QUIET = 0.01
"""Share of a channel's declared noise that plain squares tell nothing below: slow error is less
than the noise of a row (the excavator), and what rounding leaves of a still channel is no error."""

RIDGE = 1e-3
"""Prior weight while nothing is known of the discrepancy, in rows."""


@dataclass(frozen=True)
class Half:
    """Recordings with what is to be explained, and what explains.

    Attributes:
        runs: of the recordings.
        target: measured less predicted without any cause (rows, c).
        shared: change for one sd of each nuisance that both halves have, last the step's (s, rows,
            c).
        own: the same of what is drawn anew for each recording (o, rows, c).
        columns: of each trial (width, rows, c).
    """

    runs: Runs
    target: FloatArray
    shared: SingleArray
    own: SingleArray
    columns: TrialColumns

    @cached_property
    def kept(self) -> BoolArray:
        """Rows that were measured (rows, c)."""
        return self.runs.kept

    @cached_property
    def nuisances(self) -> SingleArray:
        """All nuisances, the shared ones first."""
        return np.concatenate([self.shared, self.own])

    @property
    def fixed(self) -> int:
        """How many nuisances there are, which no choice leaves out."""
        return len(self.shared) + len(self.own)

    def rms(self, rows: FloatArray) -> FloatArray:
        """Of each channel, where it was measured (c,)."""
        squares = np.where(self.kept, np.square(rows, dtype=float), 0.0)
        return np.asarray(np.sqrt(squares.sum(axis=0) / np.maximum(self.kept.sum(axis=0), 1)))


@dataclass(frozen=True)
class LinearFit:
    """Most probable amplitudes of chosen trials and nuisances.

    Attributes:
        chosen: numbers of the trials.
        whitening: the discrepancy that this fit leaves.
        scale: sd of each column's prior (k,).
        shares: amplitudes in those sd, nuisances first (k,).
        hessian: X'X + 1 in those sd (k, k).
        gradient: X'y (k,).
        samples: whitened samples that count.
        residual: (rows, c).
    """

    chosen: tuple[int, ...]
    whitening: Whitening
    scale: FloatArray
    shares: FloatArray
    hessian: FloatArray
    gradient: FloatArray
    samples: float
    residual: FloatArray


@dataclass(frozen=True)
class PlainFit:
    """Amplitudes by plain squares.

    Attributes:
        shares: amplitudes in prior sd, nuisances first (k,).
        scale: those sd (k,).
        rms: of what is left of each channel (c,).
    """

    shares: FloatArray
    scale: FloatArray
    rms: FloatArray


@dataclass(frozen=True)
class Regression:
    """Linear fits on one half.

    Attributes:
        half: the data.
        trials: what may be chosen.
        barred: labels of causes that may not be chosen any more.
    """

    half: Half
    trials: Sequence[Trial]
    barred: frozenset[str] = frozenset()

    @cached_property
    def level(self) -> FloatArray:
        """Rms of what is to be explained in each channel (c,), declared noise at least."""
        return np.asarray(np.maximum(self.half.rms(self.half.target), self.quietest / QUIET))

    @cached_property
    def quietest(self) -> FloatArray:
        """Rms of each channel below which nothing is told (c,)."""
        channels = [self.half.runs.forward.channels[c] for c in self.half.runs.columns]
        return np.maximum(QUIET * np.array([channel.sd for channel in channels]), 1e-30)

    @cached_property
    def prior(self) -> list[FloatArray]:
        """Prior sd of the amplitudes of each trial (width,)."""
        found = []
        for columns in self.half.columns.of(range(len(self.trials))):
            share = [self.half.rms(column) / self.level for column in columns]
            size = np.sqrt(np.mean(np.square(share), axis=1))
            found.append(WIDE / np.maximum(size, 1e-9))
        return found

    @cached_property
    def limits(self) -> list[tuple[FloatArray, FloatArray]]:
        """Least and largest amplitudes of each trial that its range allows, in prior sd (width,).

        Of a bent column its sign alone: it holds near its sizes, and says nothing of an end.
        """
        runs, found = self.half.runs, []
        for trial, prior in zip(self.trials, self.prior, strict=True):
            ends = np.tile([[-np.inf], [np.inf]], trial.width)
            if not trial.bent:
                at = runs.indices(trial.cause)
                unit = np.array(trial.sizes) * prior
                ends = np.sort(np.stack([runs.low[at], runs.high[at]]) / unit, axis=0)
            found.append((np.zeros(trial.width) if trial.positive else ends[0], ends[1]))
        return found

    def impossible(self, trial: int, shares: FloatArray) -> bool:
        """Whether amplitudes [prior sd] have a sign that none has, or leave their range by far."""
        low, high = self.limits[trial]
        return bool(np.any(shares < BEYOND * low) or np.any(shares > BEYOND * high))

    def design(self, chosen: Sequence[int]) -> tuple[SingleArray, FloatArray]:
        """Columns (k, rows, c) of nuisances and trials, and the prior sd of each."""
        columns = [self.half.nuisances, *self.half.columns.of(chosen)]
        return np.concatenate(columns), self.scale(chosen)

    def scale(self, chosen: Sequence[int]) -> FloatArray:
        """Prior sd of the amplitudes of nuisances and trials (k,)."""
        return np.concatenate([np.ones(self.half.fixed), *(self.prior[n] for n in chosen)])

    def residual(self, chosen: Sequence[int], amplitudes: FloatArray) -> FloatArray:
        """What amplitudes (k,) of nuisances and trials leave (rows, c)."""
        left, start = self.half.target, 0
        for columns in (self.half.nuisances, *self.half.columns.of(chosen)):
            own = amplitudes[start : start + len(columns)]
            left = left - np.tensordot(own, columns, axes=1)
            start += len(columns)
        return left

    def places(self, chosen: Sequence[int]) -> dict[int, IntArray]:
        """Where each chosen trial's columns stand in the design."""
        found, start = {}, self.half.fixed
        for n in chosen:
            width = self.trials[n].width
            found[n] = np.arange(start, start + width)
            start += width
        return found

    def whitened(self, whitening: Whitening, columns: SingleArray) -> FloatArray:
        """Columns (samples, k)."""
        return whitening.apply(columns).T

    def fit(
        self,
        chosen: Sequence[int],
        start: Whitening | None = None,
        rounds: int = ROUNDS,
        memory: bool = True,
        apart: bool = True,
    ) -> LinearFit:
        """Amplitudes and the discrepancy that they leave, in turn.

        Args:
            chosen: numbers of trials.
            start: discrepancy to begin with; plain squares if None.
            rounds: how often it is learnt anew.
            memory: whether it has a memory; only the size of each channel if not.
            apart: whether channels of a motion are by themselves where it has none.
        """
        shrinkage = usual_shrinkage(self.half.runs, memory, apart)
        whitening, residual = start, self.half.target
        if whitening is None:
            plain = self.plain(chosen)
            residual = self.residual(chosen, plain.shares * plain.scale)
        for _ in range(rounds):
            whitening = discrepancy(self.half.runs, residual, memory=memory, shrinkage=shrinkage)
            found = self.solve(chosen, whitening)
            residual = found.residual
        return self.solve(chosen, whitening) if rounds == 0 and whitening else found

    def solve(self, chosen: Sequence[int], whitening: Whitening) -> LinearFit:
        """Amplitudes under a given discrepancy."""
        scale = self.scale(chosen)
        if self._under and self._under[0].whitening is whitening:
            at = self._at(chosen)
            hessian, gradient = self._under[0].of(at, at, scale, scale), self._under[0].cross[at]
            hessian, gradient = hessian + np.eye(len(scale)), scale * gradient
        else:
            design = self.whitened(whitening, self.design(chosen)[0]) * scale
            hessian = inner(design, design) + np.eye(len(scale))
            gradient = design.T @ whitening.apply(self.half.target.astype(np.float32))
        shares = np.asarray(np.linalg.solve(hessian, gradient), float)
        residual = self.residual(chosen, shares * scale)
        samples = float(np.sum(whitening.freedom))
        return LinearFit(
            tuple(chosen), whitening, scale, shares, hessian, gradient, samples, residual
        )

    def plain(
        self, chosen: Sequence[int], weights: FloatArray | None = None, prior: float = RIDGE
    ) -> PlainFit:
        """Amplitudes by plain squares, and what they leave of each channel.

        Args:
            chosen: numbers of trials.
            weights: of the squares of each channel in units of its level (c,); one if None.
            prior: weight of the squares of amplitudes in their prior sd.
        """
        power = self._products[2]
        weights = np.ones(len(power)) if weights is None else weights
        if not (self._last and self._last[0].serves(weights, prior)):
            own = Eliminated.of(self._products, self.half.fixed, weights, prior)
            self._last[:] = [own]
        scale = self.scale(chosen)
        at = self._at(chosen)[self.half.fixed :] - self.half.fixed
        shares, left = self._last[0].fit(at, scale[self.half.fixed :])
        mean = np.maximum(left, 0.0) / np.maximum(self.half.kept.sum(axis=0), 1)
        return PlainFit(shares, scale, np.maximum(self.level * np.sqrt(mean), self.quietest))

    def plain_error(self, chosen: Sequence[int]) -> float:
        """Sum over channels of the log of what plain least squares leave, in their units."""
        return float(np.sum(np.log(self.plain(chosen).rms)))

    def price(self, samples: float, width: int) -> float:
        """Least fall of chi^2 for which trials enter: the extended Bayesian criterion.

        Args:
            samples: that count.
            width: columns of the trials.

        Source: Chen and Chen 2008, Extended Bayesian information criteria, Biometrika 95.
        """
        return float(width * (np.log(max(samples, 1.0)) + 2.0 * np.log(max(self._causes, 1))))

    def width(self, trials: Sequence[int]) -> int:
        """Columns of trials together."""
        return sum(self.trials[n].width for n in trials)

    def rest(self, chosen: Sequence[int]) -> list[int]:
        """Trials of causes that are not chosen yet."""
        used = self.barred | {self.trials[n].cause.label for n in chosen}
        return [n for n, trial in enumerate(self.trials) if trial.cause.label not in used]

    def variants(self, trial: int) -> list[int]:
        """Trials of the same cause."""
        label = self.trials[trial].cause.label
        return [n for n, other in enumerate(self.trials) if other.cause.label == label]

    @cached_property
    def _causes(self) -> int:
        """How many causes may be chosen."""
        return len({trial.cause.label for trial in self.trials})

    @cached_property
    def _columns(self) -> list[IntArray]:
        """Where each trial's columns stand behind the nuisances, all trials in turn."""
        widths = [trial.width for trial in self.trials]
        ends = np.cumsum([self.half.fixed, *widths])
        return [np.arange(a, b) for a, b in pairwise(ends)]

    @cached_property
    def _products(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Of each channel in its level, columns by columns, by target, and target by itself.

        (c, k, k), (c, k) and (c,): plain least squares of any choice cost no more columns.
        """
        kept, every = self.half.kept, self.half.columns.of(range(len(self.trials)))
        columns = np.where(kept, np.concatenate([self.half.nuisances, *every]) / self.level, 0.0)
        target = np.where(kept, self.half.target / self.level, 0.0)
        weighed = np.moveaxis(columns, 2, 0).astype(float)
        gram = np.stack([inner(part.T, part.T) for part in weighed])
        cross = np.stack([part @ column for part, column in zip(weighed, target.T, strict=True)])
        return gram, cross, np.sum(np.square(target), axis=0)

    @cached_property
    def _last(self) -> list[Eliminated]:
        """Plain squares by the weights that were asked for last; none at first."""
        return []

    def gains(self, fit: LinearFit, others: Sequence[int]) -> Gains:
        """Chi^2 that each of other trials would take beside a fit, under its discrepancy."""
        under = self._products_under(fit.whitening)
        inside, outside, weight = self._at(fit.chosen), *self._outside(others)
        cross = under.of(outside, inside, weight, fit.scale)
        gram = under.of(outside, outside, weight, weight)
        gram -= cross @ np.linalg.solve(fit.hessian, cross.T)
        return self._gains(others, gram, weight * under.cross[outside] - cross @ fit.shares)

    def plain_gains(self, fit: LinearFit, others: Sequence[int]) -> Gains:
        """Plain squares that each would take of what a fit leaves, in the rms of each channel.

        No amplitude of the fit gives way.
        """
        gram, cross, _ = self._products
        weights = np.square(self.level / np.maximum(self.half.rms(fit.residual), 1e-30))
        (outside, weight), at = self._outside(others), self._at(fit.chosen)
        left = cross[:, outside] - gram[:, outside[:, None], at] @ (fit.shares * fit.scale)
        own = np.tensordot(weights, gram, axes=1)[np.ix_(outside, outside)]
        return self._gains(others, own * np.outer(weight, weight), weight * (weights @ left))

    def _outside(self, others: Sequence[int]) -> tuple[IntArray, FloatArray]:
        """Columns of trials, and the prior sd of each."""
        places = np.concatenate([self._columns[n] for n in others])
        return places, np.concatenate([self.prior[n] for n in others])

    def _gains(self, others: Sequence[int], gram: FloatArray, slope: FloatArray) -> Gains:
        ends = np.cumsum([0, *(self.trials[n].width for n in others)])
        where = {n: np.arange(ends[k], ends[k + 1]) for k, n in enumerate(others)}
        low, high = (np.concatenate([self.limits[n][k] for n in others]) for k in (0, 1))
        return Gains(gram, slope, where, low, high)

    def _at(self, chosen: Sequence[int]) -> IntArray:
        """Where nuisances and chosen trials stand among all columns."""
        nuisances = np.arange(self.half.fixed)
        return np.concatenate([nuisances, *(self._columns[n] for n in chosen)]).astype(int)

    @cached_property
    def _under(self) -> list[Products]:
        """Products under the discrepancy that was asked for last; none at first."""
        return []

    def _products_under(self, whitening: Whitening) -> Products:
        """Of all columns: an exchange tries many choices under one discrepancy."""
        if not (self._under and self._under[0].whitening is whitening):
            every = [self.half.nuisances, *self.half.columns.of(range(len(self.trials)))]
            rows = whitening.apply(np.concatenate(every))
            target = whitening.apply(self.half.target.astype(np.float32))
            self._under[:] = [Products(whitening, inner(rows.T, rows.T), rows @ target)]
        return self._under[0]
