"""Whitening: residuals in units of measurement noise, white in time and across channels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
from scipy.linalg import solve_toeplitz
from scipy.signal import detrend, lfilter

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.recording import Recording
from ves_twin.core.types import BoolArray, FloatArray, SingleArray
from ves_twin.diagnosis.record.runs import Runs

ORDER = 8
"""Order of the autoregression, as in the study behind the method (AR(8))."""

SILENT = 1e-3
"""Share of its declared noise power below which a channel's standstill tells nothing."""

FLOOR_FROM = 0.3
"""Share of the Nyquist rate above which a residual is taken as noise: 15 Hz of 50 Hz."""

LEVEL_RANGE = (0.4, 2.5)
"""Limits of the noise power that a record may claim for itself, against the declared one."""

FEWEST = 70
"""Whitened samples of a channel between its holes below which its noise cannot be told."""

COLOURS = np.linspace(-0.3, 0.45, 31)
"""Lag-one colours that are tried when a record's own noise is fitted."""


@dataclass(frozen=True)
class Whitening:
    """z = C A(q) r: an autoregression for each channel, then C across the channels.

    A noise e with autocovariance g obeys sum_j a_j e[t - j] = w[t] (Yule-Walker), so A(q) e is
    white with covariance S, and C = chol(S)^-1 makes it unit and uncorrelated.

    Attributes:
        runs: whose rows are whitened.
        filters: a_0 = 1, a_1 ... of each recording and channel (recordings, c, ORDER + 1).
        mixing: C of each recording (recordings, c, c).
        colour: lag-one coefficient left in each recording and whitened channel (recordings, c).
        level: sd of what is then left (recordings, c).
        measured: whether a standstill recording told it.
    """

    runs: Runs
    filters: FloatArray
    mixing: FloatArray
    colour: FloatArray
    level: FloatArray
    measured: bool = False

    def lost(self, recording: int) -> int:
        """Rows at the begin that the filters need; poses at rest have noise without memory."""
        return 0 if self.runs.programmes[recording].poses else ORDER + 1

    def apply(self, stack: SingleArray) -> FloatArray:
        """Whitened rows, flattened: (..., rows, c) -> (..., samples)."""
        return self.finished(self.prewhitened(stack))

    def prewhitened(self, stack: SingleArray) -> list[FloatArray]:
        """Without colour and level, which `adapted` changes: (..., rows, c) of each recording."""
        return [self._mixed(k, stack[..., rows, :]) for k, rows in enumerate(self.runs.slices)]

    def finished(self, parts: Sequence[FloatArray]) -> FloatArray:
        """What `prewhitened` gave, with colour and level, flattened: (..., samples)."""
        pieces = [self._levelled(k, part) for k, part in enumerate(parts)]
        z = np.concatenate(
            [p.reshape(*p.shape[:-2], p.shape[-2] * p.shape[-1]) for p in pieces], -1
        )
        return z if self.weights is None else z * self.weights

    @cached_property
    def weights(self) -> FloatArray | None:
        """1 for samples (samples,) that rest on measurements alone, 0 for others; None if all do.

        A sample rests on ORDER + 2 rows, and where channels are mixed on all of them.
        """
        if not any(bad.any() for bad in self.runs.holes):
            return None
        parts = []
        for k, (bad, mixing) in enumerate(zip(self.runs.holes, self.mixing, strict=True)):
            mixed = np.count_nonzero(mixing - np.diag(np.diag(mixing))) > 0
            each = np.repeat(bad.any(axis=1, keepdims=True), bad.shape[1], 1) if mixed else bad
            parts.append(whole(each, self.lost(k)).astype(float).ravel())
        return np.concatenate(parts)

    @cached_property
    def freedom(self) -> FloatArray:
        """Samples that count (samples,), as 1 and 0."""
        if self.weights is not None:
            return self.weights
        pairs = enumerate(self.runs.slices)
        count = sum(s.stop - s.start - self.lost(k) for k, s in pairs)
        return np.ones(count * self.mixing.shape[1])

    @cached_property
    def samples(self) -> tuple[slice, ...]:
        """Whitened samples of each recording."""
        width, pairs = self.mixing.shape[1], enumerate(self.runs.slices)
        counts = [(rows.stop - rows.start - self.lost(k)) * width for k, rows in pairs]
        return tuple(slice(int(a), int(b)) for a, b in pairwise(np.cumsum([0, *counts])))

    def blocks(self, z: FloatArray) -> list[FloatArray]:
        """Whitened samples by recording: (samples,) -> (rows, c) each."""
        return [z[here].reshape(-1, self.mixing.shape[1]) for here in self.samples]

    def times(self) -> list[FloatArray]:
        """Times [s] of the whitened rows of each recording."""
        return [time[self.lost(k) :] for k, time in enumerate(self.runs.times)]

    def adapted(self, z: FloatArray) -> Whitening:
        """With level and lag-one colour as this record shows them above FLOOR_FROM (Whittle fit).

        Minimises mean(I/(s g)) + log s + mean(log g) over s and g = |1 - rho e^-iw|^-2. A median
        would resist lines better, but costs a fifth of the precision.

        Args:
            z: whitened residual of this record.
        """
        colour, level = self.colour.copy(), self.level.copy()
        for k, (block, kept) in enumerate(
            zip(self.blocks(z), self.blocks(self.freedom), strict=True)
        ):
            power, angle = _periodogram(block)
            power = power / np.mean(kept, axis=0)
            shapes = 1.0 / np.abs(1.0 - COLOURS[:, None] * np.exp(-1j * angle)) ** 2
            scale = np.maximum(np.mean(power[None] / shapes[:, :, None], axis=1), 1e-300)
            cost = np.log(scale) + np.mean(np.log(shapes), axis=1)[:, None]
            if self.runs.programmes[k].poses:
                cost[np.abs(COLOURS) > 1e-9] = np.inf
            best = np.argmin(cost, axis=0)
            colour[k] = np.clip(self.colour[k] + COLOURS[best], COLOURS[0], COLOURS[-1])
            found = np.sqrt(scale[best, np.arange(len(best))]) * self.level[k]
            low, high = np.sqrt(LEVEL_RANGE)
            level[k] = np.clip(found, low, high)
        return replace(self, colour=colour, level=level)

    def floor(self, z: FloatArray) -> float:
        """Mean z^2 that noise alone leaves: 1, but less where a channel is quieter than it may say.

        Args:
            z: whitened residual of this record (samples,), where it is noise: above FLOOR_FROM.
        """
        energy, count = 0.0, 0.0
        lowest = np.sqrt(LEVEL_RANGE[0])
        for k, (block, kept) in enumerate(
            zip(self.blocks(z), self.blocks(self.freedom), strict=True)
        ):
            share = np.mean(kept, axis=0)
            power = np.mean(_periodogram(block)[0], axis=0) / share
            held = (self.level[k] <= lowest) & (power < 1.0)
            energy += len(block) * float(np.sum(share * np.where(held, power, 1.0)))
            count += len(block) * float(np.sum(share))
        return energy / count

    def draw(self, rng: np.random.Generator, level: float, colour: float) -> SingleArray:
        """Noise (rows, c) that this whitening takes as unit white, but for a level and a colour."""
        parts = []
        for k, rows in enumerate(self.runs.slices):
            count = rows.stop - rows.start + 50
            white = level * rng.standard_normal((count, self.mixing.shape[1]))
            memory = 0.0 if self.runs.programmes[k].poses else colour
            tinted = lfilter([1.0], [1.0, -memory], white, axis=0)
            mixed = np.linalg.solve(self.mixing[k], tinted.T).T
            shaped = [lfilter([1.0], a, mixed[:, c]) for c, a in enumerate(self.filters[k])]
            parts.append(np.stack(shaped, axis=1)[50:])
        return np.concatenate(parts).astype(np.float32)

    def _mixed(self, k: int, rows: SingleArray) -> FloatArray:
        if self.runs.programmes[k].poses:
            return np.asarray(rows @ self.mixing[k].T)
        if rows.size == 0:  # a bank whose every entry is a column has no shapes of its own
            return np.zeros((*rows.shape[:-2], rows.shape[-2] - ORDER, rows.shape[-1]))
        width, count = rows.shape[-1], rows.shape[-2] - ORDER
        flat, taps = _in_line(rows), np.tile(self.filters[k].T, count)
        shaped = flat[..., ORDER * width :] * taps[0]
        for lag in range(1, ORDER + 1):
            begin = (ORDER - lag) * width
            shaped += flat[..., begin : begin + count * width] * taps[lag]
        return np.asarray(shaped.reshape(*rows.shape[:-2], count, width) @ self.mixing[k].T)

    def _levelled(self, k: int, white: FloatArray) -> FloatArray:
        if self.runs.programmes[k].poses:
            return np.asarray(white / self.level[k])
        width, count = white.shape[-1], max(white.shape[-2] - 1, 0)
        flat, colour = _in_line(white), np.tile(self.colour[k], count)
        left = flat[..., width:] - colour * flat[..., : count * width]
        left /= np.tile(self.level[k], count)
        return np.asarray(left.reshape(*white.shape[:-2], count, width))


def _in_line(rows: FloatArray | SingleArray) -> FloatArray | SingleArray:
    """Rows (..., n, c) as (..., n c): lines are several times as fast as rows of few channels."""
    return rows.reshape(*rows.shape[:-2], rows.shape[-2] * rows.shape[-1])


def whitening_of(runs: Runs, standstill: Recording | None) -> Whitening:
    """Noise as a standstill recording tells it, else as declared."""
    return whitening_declared(runs) if standstill is None else whitening_measured(runs, standstill)


def whole(bad: BoolArray, memory: int) -> BoolArray:
    """Samples that rest on measurements alone (rows - memory, c).

    Args:
        bad: rows of the grid without a measurement (rows, c).
        memory: earlier rows that a sample rests on.
    """
    lost = [bad[j : len(bad) - memory + j] for j in range(memory + 1)]
    return np.asarray(~np.any(lost, axis=0))


def whitening_declared(runs: Runs) -> Whitening:
    """Whitening from the declared noise of each channel, as the analysis grid shapes it."""
    channels = [runs.forward.channels[c] for c in runs.columns]
    covariances = [
        np.array([grid.autocovariance(channel.sd, ORDER, channel.corner) for channel in channels])
        for grid in runs.grids
    ]
    return _whitening(runs, covariances, [np.eye(len(channels))] * len(runs.grids))


def whitening_measured(runs: Runs, standstill: Recording) -> Whitening:
    """Whitening learnt from a recording of the rig standing still.

    Args:
        runs: whose rows will be whitened; all recordings must share the standstill's period.
        standstill: nothing moves in it, so what it shows beyond a slow line is noise.

    Raises:
        InvalidInputError: shorter than 20 rows of the grid for each coefficient, or another rate.
    """
    channels = [runs.forward.channels[c] for c in runs.columns]
    rows = np.stack([standstill[c.signal][:, c.column] for c in channels], axis=1)
    if not np.all(np.isfinite(rows)):
        raise InvalidInputError("standstill recording", "rows without a value", "numbers")
    grid = runs.grids[0]
    period = float(np.mean(np.diff(standstill.time)))
    if any(abs(g.period / period - 1.0) > 0.01 for g in runs.grids):
        raise InvalidInputError("standstill period [s]", period, f"{grid.period} as recorded")
    noise = detrend(grid.reduce(rows), axis=0)
    count = len(noise)
    if count < 20 * ORDER:
        raise InvalidInputError("standstill rows on the grid", count, f"at least {20 * ORDER}")
    products = [noise[: count - j].T @ noise[j:] / count for j in range(ORDER + 1)]
    covariance = np.array([np.diag(p) for p in products]).T
    silent = covariance[:, 0] < SILENT * np.array([channel.sd for channel in channels]) ** 2
    for c in np.flatnonzero(silent):  # a standing encoder shows one count and no noise
        covariance[c] = grid.autocovariance(channels[c].sd, ORDER)
        noise[:, c] = channels[c].sd * np.random.default_rng(c).standard_normal(count)
    filters = prediction_filters(covariance)
    inner = np.stack([lfilter(a, [1.0], noise[:, c])[ORDER:] for c, a in enumerate(filters)])
    correlation = np.atleast_2d(np.corrcoef(inner))
    copies = len(runs.grids)
    found = _whitening(runs, [covariance] * copies, [correlation] * copies)
    for programme, kept in zip(runs.programmes, found.blocks(found.freedom), strict=True):
        count = int(np.min(np.sum(kept, axis=0)))
        if count < FEWEST and not programme.poses:
            raise InvalidInputError(
                f"samples of {programme.name} between the holes of all channels",
                count,
                f"at least {FEWEST}: a standstill mixes the channels; leave the holed ones out",
            )
    return replace(found, measured=True)


def _whitening(
    runs: Runs, covariances: Sequence[FloatArray], correlations: Sequence[FloatArray]
) -> Whitening:
    filters, mixing = [], []
    for covariance, correlation in zip(covariances, correlations, strict=True):
        a = prediction_filters(covariance)
        sd = np.sqrt(np.sum(a * covariance, axis=1))
        filters.append(a)
        mixing.append(np.linalg.inv(np.linalg.cholesky(correlation * np.outer(sd, sd))))
    shape = (len(filters), len(runs.columns))
    return Whitening(runs, np.array(filters), np.array(mixing), np.zeros(shape), np.ones(shape))


def prediction_filters(covariance: FloatArray) -> FloatArray:
    """Yule-Walker: autocovariances (c, ORDER + 1) -> prediction-error filters (c, ORDER + 1)."""
    rows = []
    for g in covariance:
        column = g.copy()
        column[0] *= 1.0 + 1e-6  # a pure line would make the system singular
        rows.append(np.concatenate([[1.0], solve_toeplitz(column[:-1], -column[1:])]))
    return np.array(rows)


def _periodogram(block: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Power (f, c) and angle [rad a sample] (f,) of the part that is taken as noise."""
    spectrum = np.abs(np.fft.rfft(block, axis=0)) ** 2 / len(block)
    angle = np.linspace(0.0, np.pi, len(spectrum))
    kept = (angle > FLOOR_FROM * np.pi) & (angle < 0.98 * np.pi)
    return np.asarray(spectrum[kept]), np.asarray(angle[kept])
