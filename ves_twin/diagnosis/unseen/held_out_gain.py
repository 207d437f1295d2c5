"""held_out_gain: does the extended model predict recordings that it has not seen better?"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from ves_twin.core.types import FloatArray, IntArray, SingleArray
from ves_twin.diagnosis.bank.linearise import STIFF, Linearisation, linearise, strangeness
from ves_twin.diagnosis.bank.metric import Metric
from ves_twin.diagnosis.fit.refine import Fit
from ves_twin.diagnosis.record.runs import Runs
from ves_twin.diagnosis.record.whitening import Whitening
from ves_twin.diagnosis.unseen.gain import Gain

BLOCK_SECONDS = 0.5
"""Length of the stretches of time that are drawn again: longer than a residual remembers."""

FORWARD_STEP = 1.0
"""Of the fit's own sd, or of the prior of what is new: one side, where nothing moves on."""

DRAWS = 2000
"""Resamples of the stretches."""

LEAST_EXCESS = 0.25
"""Of a resample, as a share of the whole's: what a share is taken of must not vanish."""

INVISIBLE = 0.02
"""Excess of mean z^2 over noise below which the held-out recording does not show the effect."""


class DivergedError(ArithmeticError):
    """A plant, as it was fitted, diverges on other recordings."""


def held_out_gain(
    runs: Runs,
    measured: SingleArray,
    whitening: Whitening,
    nominal: Fit,
    extended: Fit,
    confidence: float = 0.90,
    seed: int = 0,
    base: Linearisation | None = None,
) -> Gain:
    """Predict held-out recordings by both models and compare.

    Each model carries over what the first recordings told of its nuisances, mean and covariance;
    those that are new in each recording have their prior. z' (I + N N')^-1 z is then chi^2 with as
    many degrees of freedom as samples, if the model is right.

    Args:
        runs: of the held-out recordings.
        measured: their channels (rows, c).
        whitening: their noise.
        nominal: fit of commissioning errors alone to the first recordings.
        extended: fit of the causes to them.
        confidence: of the interval.
        seed: of the resampling.
        base: of these recordings where nothing departs, if it is known: its columns serve where
            they do not bend.

    Raises:
        DivergedError: no number is predicted there.
    """
    better = _Carried.of(runs, extended, base)
    if not np.all(np.isfinite(better.local.prediction)):
        raise DivergedError
    plain = better.beside(extended, nominal)
    own = whitening.adapted(better.left(measured, whitening))
    floor = own.floor(better.left(measured, own))
    after, before = better.energies(measured, own), plain.energies(measured, own)
    error_after, error_before = better.errors(measured), plain.errors(measured)
    names = [runs.forward.channels[c].name for c in runs.columns]
    pairs = zip(error_before, error_after, strict=True)
    errors = {n: (float(a), float(b)) for n, (a, b) in zip(names, pairs, strict=True)}
    start = runs.one(runs.origin) if base is None else base.prediction
    given = dict(zip(names, _rms(runs, measured - start).tolist(), strict=True))
    lengths = _stretches(runs, own)
    seen = lengths > 0.0  # a stretch before what is compared has no sample
    after, before, lengths = after[seen], before[seen], lengths[seen]
    rng = np.random.default_rng(seed)
    drawn = rng.integers(0, len(lengths), (DRAWS, len(lengths)))
    a, b, n = after[drawn].sum(1), before[drawn].sum(1), lengths[drawn].sum(1)
    mean_before, mean_after = before.sum() / lengths.sum(), after.sum() / lengths.sum()
    without = float(better.without(extended).energies(measured, own).sum() / lengths.sum())
    means, excess = (float(mean_before), float(mean_after)), mean_before - floor
    if not excess >= INVISIBLE:  # nor is there any where no row is compared
        return Gain(None, None, None, *means, errors, without, given)
    # each resample by its own excess: where stretches differ in size, before and after go together
    shares = (b - a) / n / np.maximum(b / n - floor, LEAST_EXCESS * excess)
    tail = 0.5 * (1.0 - confidence)
    low, high = np.quantile(shares, [tail, 1.0 - tail])
    share = (mean_before - mean_after) / excess
    return Gain(float(share), float(low), float(high), *means, errors, without, given)


@dataclass(frozen=True)
class _Known:
    """Columns at some point of the held-out recordings, which serve at others too.

    Attributes:
        local: prediction there, and the columns.
        place: coordinate -> its column.
        sd: for how much of the coordinate each column is.
    """

    local: Linearisation
    place: Mapping[int, int]
    sd: FloatArray

    @staticmethod
    def of(base: Linearisation) -> _Known:
        """Of a linearisation over all commissioning tolerances."""
        runs = base.runs
        place = {int(i): n for n, i in enumerate(runs.nuisances)}
        return _Known(base, place, runs.sd[runs.nuisances])

    def at(self, axes: _Axes, renewing: bool = True) -> _Carried:
        """Carried over by these columns; those that bend on the way are computed, if wanted."""
        runs = self.local.runs
        where, sd, bends = axes.where, np.concatenate([axes.sd, axes.drawn]), axes.bends
        rows = np.array([self.place.get(int(i), -1) for i in where], int)
        share = np.where(rows >= 0, sd / self.sd[rows], 0.0).astype(np.float32)
        columns = self.local.columns[[*rows, -1]]
        columns[:-1] *= share[:, None, None]
        prediction, anew = runs.one(axes.point), rows < 0
        if renewing:
            told = np.minimum(sd / np.maximum(runs.sd[where], 1e-30), 1.0)  # of a commissioning sd
            anew |= bends * told * strangeness(self.local, prediction) > STIFF
        bent = np.flatnonzero(anew)
        if renewing or len(bent):
            some = where[bent], sd[bent]
            there = linearise(runs, axes.point, axes=some, forward_step=FORWARD_STEP)
            columns[[*bent, -1]] = there.columns
        local = Linearisation(runs, axes.point, prediction, columns, np.append(bends, 0.0))
        return _Carried(local, axes.root)


@dataclass(frozen=True)
class _Carried:
    """A fit carried over to other recordings.

    Attributes:
        local: prediction there, and columns for one sd of what is carried and of what is new.
        root: of the carried covariance, in those sd (carried, carried).
    """

    local: Linearisation
    root: FloatArray

    @staticmethod
    def of(runs: Runs, fit: Fit, base: Linearisation | None) -> _Carried:
        axes = _Axes.of(runs, fit)
        if base is not None:
            return _Known.of(replace(base, runs=runs)).at(axes)  # a plant with more parameters
        every = axes.where, np.concatenate([axes.sd, axes.drawn])
        return _Carried(
            linearise(runs, axes.point, axes=every, forward_step=FORWARD_STEP), axes.root
        )

    def beside(self, one: Fit, other: Fit) -> _Carried:
        """Another fit, by the columns of this one.

        They are wrong where the two are far apart. The other then leaves far more than noise, of
        which what columns can take is a small share.
        """
        runs = self.local.runs
        mine = _Axes.of(runs, one)
        place = {int(i): n for n, i in enumerate(mine.where)}
        known = _Known(self.local, place, np.concatenate([mine.sd, mine.drawn]))
        return known.at(_Axes.of(runs, other), renewing=False)

    def without(self, fit: Fit) -> _Carried:
        """The same with the causes of the fit taken out: nominal there, all else as carried."""
        runs = self.local.runs
        point = self.local.point.copy()
        for cause in fit.causes:
            where = runs.indices(cause)
            point[where] = runs.origin[where]
        return replace(self, local=replace(self.local, prediction=runs.one(point)))

    def left(self, measured: SingleArray, whitening: Whitening) -> FloatArray:
        """What the nuisances cannot explain, whitened (samples,)."""
        return self._metric(whitening).project(whitening.apply(measured - self.local.prediction))

    def energies(self, measured: SingleArray, whitening: Whitening) -> FloatArray:
        """Predictive chi^2 of each stretch of time: what is left there, and its share of the pull.

        z' (I + N N')^-1 z = |z - N b|^2 + |b|^2; z times what is left would be a sum too, but of
        parts that cancel where the model is far off.
        """
        z = whitening.apply(measured - self.local.prediction)
        metric, runs = self._metric(whitening), self.local.runs
        pull = metric.nuisances(z)
        squares = whitening.blocks(np.square(metric.project(z)))
        left = np.concatenate(
            [
                np.add.reduceat(np.sum(block, axis=1), _starts(runs, k, len(block)))
                for k, block in enumerate(squares)
            ]
        )
        lengths = _stretches(runs, whitening)
        return np.asarray(left + float(pull @ pull) * lengths / lengths.sum())

    def errors(self, measured: SingleArray) -> FloatArray:
        """Rms of each channel over the rows that were measured."""
        return _rms(self.local.runs, measured - self.local.prediction)

    def _metric(self, whitening: Whitening) -> Metric:
        columns = whitening.apply(self.local.columns).T
        count = len(self.root)
        return Metric(np.concatenate([columns[:, :count] @ self.root, columns[:, count:]], axis=1))


@dataclass(frozen=True)
class _Axes:
    """What a fit says of other recordings.

    Attributes:
        point: departures there.
        carried: coordinates that both have, with the fit's own sd, and the covariance's root.
        new: coordinates drawn anew for each recording, with their prior sd `drawn`.
        bends: how much each column, carried and new, changes over a rig [sigma].
    """

    point: FloatArray
    carried: IntArray
    sd: FloatArray
    root: FloatArray
    new: IntArray
    drawn: FloatArray
    bends: FloatArray

    @property
    def where(self) -> IntArray:
        """All coordinates, carried and new."""
        return np.concatenate([self.carried, self.new])

    @staticmethod
    def of(runs: Runs, fit: Fit) -> _Axes:
        there = fit.local.runs
        shared = [n for n, i in enumerate(fit.active) if there.coordinates[i].recording == -1]
        names = [axis.parameter.name for axis in runs.coordinates]
        labels = [there.coordinates[i].parameter.name for i in fit.active[shared]]
        carried = np.array([names.index(label) for label in labels], int)
        point = runs.origin
        point[carried] = fit.shift[fit.active[shared]]
        new = np.array([i for i in runs.nuisances if runs.coordinates[i].recording != -1], int)
        covariance = fit.posterior[np.ix_(shared, shared)]
        sd = np.sqrt(np.maximum(np.diag(covariance), 1e-30))
        values, vectors = np.linalg.eigh(covariance / np.outer(sd, sd))
        root = vectors * np.sqrt(np.maximum(values, 0.0))
        every = [there.coordinates[i].parameter.name for i in there.nuisances]
        bend = dict(zip(every, fit.local.bends[:-1], strict=True))
        bends = np.array([bend.get(names[i], np.inf) for i in [*carried, *new]])
        return _Axes(point, carried, sd, root, new, runs.sd[new], bends)


def _rms(runs: Runs, off: SingleArray) -> FloatArray:
    """Rms of each channel of rows (rows, c) over those that were measured."""
    squares = np.sum(np.square(off, dtype=float), axis=0, where=runs.kept)
    return np.asarray(np.sqrt(squares / np.sum(runs.kept, axis=0)))


def _starts(runs: Runs, k: int, rows: int) -> IntArray:
    stride = max(1, round(BLOCK_SECONDS / runs.grids[k].step))
    return np.arange(0, max(rows - stride // 2, 1), stride, dtype=np.int64)


def _stretches(runs: Runs, whitening: Whitening) -> FloatArray:
    """Samples in each stretch."""
    ones = whitening.freedom
    parts = [
        np.add.reduceat(np.sum(block, axis=1), _starts(runs, k, len(block)))
        for k, block in enumerate(whitening.blocks(ones))
    ]
    return np.concatenate(parts)
