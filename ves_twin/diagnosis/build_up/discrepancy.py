"""discrepancy: what no cause explains, as coloured noise of its own size in each channel."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.record.runs import Runs
from ves_twin.diagnosis.record.whitening import ORDER, Whitening, prediction_filters

SHRINKAGE = 0.1
"""Usual share of the innovations' covariance that is taken without its correlations between
channels: keeps it regular where channels are many and rows few. Chosen on TX40."""

WHITE = 0.01
"""White noise that is added to the discrepancy, as a share of its variance: limits the filter's
range to 20 dB, beyond which slow causes would be whitened away. Chosen on TX40 and the damper."""


def usual_shrinkage(runs: Runs, memory: bool, apart: bool = True) -> float:
    """Share of the covariance without correlations: all of it for plain squares of a motion.

    What missed causes leave goes along in many channels: five axes' frictions pulled that of a
    sixth from 10 to 2.7 N m s/rad (a Schunk LWA 4P). Innovations in time are nearly white, and
    poses at rest share a drift (a wrist's sensor).
    """
    moving = not all(programme.poses for programme in runs.programmes)
    return 1.0 if moving and apart and not memory else SHRINKAGE


def discrepancy(
    runs: Runs,
    residual: FloatArray,
    white: float = WHITE,
    memory: bool = True,
    shrinkage: float = SHRINKAGE,
) -> Whitening:
    """Whitening by which a residual is white: sensor noise and model error together.

    An autoregression of each channel by Yule-Walker, pooled over all recordings, then the inverse
    root of the innovations' covariance across channels. No channel is quieter than its declared
    noise.

    Args:
        runs: whose rows these are.
        residual: measured less predicted (rows, c).
        white: noise that is added, as a share of the variance.
        memory: whether rows are whitened in time; plain squares if not.
        shrinkage: share that is taken channel by channel, without correlations; 1: all of it.
    """
    covariance = _autocovariance(runs, residual)
    channels = [runs.forward.channels[c] for c in runs.columns]
    declared = np.array([runs.grids[0].autocovariance(c.sd, ORDER, c.corner) for c in channels])
    quiet = covariance[:, 0] < declared[:, 0]
    covariance[quiet] = declared[quiet]
    covariance[:, 0] *= 1.0 + white
    covariance[:, 1:] *= memory
    declared[:, 1:] *= memory
    copies, width = len(runs.slices), len(channels)
    plain = Whitening(
        runs,
        np.tile(prediction_filters(covariance), (copies, 1, 1)),
        np.tile(np.eye(width), (copies, 1, 1)),
        np.zeros((copies, width)),
        np.ones((copies, width)),
    )
    inner = plain.apply(residual.astype(np.float32)).reshape(-1, width)
    whole = plain.freedom.reshape(-1, width).all(axis=1)
    inner = inner[whole] if np.count_nonzero(whole) > 2 * width else inner
    spread = inner.T @ inner / len(inner)
    quietest = np.sum(prediction_filters(declared) * declared, axis=1)
    spread += np.diag(np.maximum(quietest - np.diag(spread), 0.0))
    own = np.diag(np.diag(spread))
    root = np.linalg.cholesky((1.0 - shrinkage) * spread + shrinkage * own)
    return replace(plain, mixing=np.tile(np.linalg.inv(root), (copies, 1, 1)))


def carried(found: Whitening, runs: Runs) -> Whitening:
    """The same discrepancy on other recordings."""
    shape = (len(runs.slices), len(runs.columns))
    return Whitening(
        runs,
        np.tile(found.filters[0], (shape[0], 1, 1)),
        np.tile(found.mixing[0], (shape[0], 1, 1)),
        np.zeros(shape),
        np.ones(shape),
    )


def apart(found: Whitening) -> Whitening:
    """The same with every channel by itself, its innovations in the channel's unit."""
    return replace(found, mixing=np.tile(np.eye(found.mixing.shape[1]), (len(found.mixing), 1, 1)))


def _autocovariance(runs: Runs, residual: FloatArray) -> FloatArray:
    """Of each channel (c, ORDER + 1), over the rows that were measured: the biased estimate."""
    kept = runs.kept
    rows = np.where(kept, residual, 0.0)
    found = np.zeros((residual.shape[1], ORDER + 1))
    for piece in runs.slices:
        x = rows[piece]
        for lag in range(min(ORDER + 1, len(x))):
            found[:, lag] += np.sum(x[: len(x) - lag] * x[lag:], axis=0)
    return np.asarray(found / np.maximum(np.sum(kept, axis=0), 1)[:, None])
