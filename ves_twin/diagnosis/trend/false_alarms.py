"""false_alarm_limits: what the best change in a library does on a rig on which nothing changed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.model.forward import Hypothesis
from ves_twin.diagnosis.trend.joint import LEAST, Joint, directions
from ves_twin.diagnosis.trend.shapes import Shapes

BEYOND = 100
"""Draws beyond a limit, which make the stated rate true to a tenth."""

CHUNK = 2000
"""Draws at a time."""


@dataclass(frozen=True)
class Limits:
    """chi^2 that the best of all causes passes with probability alpha where there is nothing.

    Attributes:
        alpha: the stated rate for a whole series of recordings: of a change or of sizes that vary,
            half of it each, and of a constant cause.
        change: best change over all causes, shapes and dates.
        varies: sizes that differ from day to day in any way.
        constant: best constant size.
    """

    alpha: float
    change: float
    varies: float
    constant: float


@dataclass(frozen=True)
class Scores:
    """Of each draw, or of a record, by cause (draws, causes)."""

    change: FloatArray
    varies: FloatArray
    constant: FloatArray


def scores(joint: Joint, shapes: Shapes, causes: Sequence[Hypothesis], drawn: FloatArray) -> Scores:
    """Scores of every cause.

    Args:
        joint: what the recordings tell.
        shapes: changes that are looked for.
        causes: whose signs a constant size keeps to.
        drawn: u of records (draws, causes, n).
    """
    change, varies, constant = np.zeros((3, *drawn.shape[:2]))
    for h, cause in enumerate(causes):
        power = joint.power(h)
        if not np.any(power):
            continue
        change[:, h] = np.max((drawn[:, h] @ directions(power, shapes.columns).T) ** 2, axis=1)
        along = np.sum(drawn[:, h], axis=1)
        level = along**2 / np.sum(power)
        each = np.linalg.pinv(power, LEAST, True)
        varies[:, h] = np.einsum("ri,ij,rj->r", drawn[:, h], each, drawn[:, h]) - level
        constant[:, h] = np.where((along < 0.0) & (-1 not in cause.signs), 0.0, level)
    return Scores(change, varies, constant)


def false_alarm_limits(
    joint: Joint, shapes: Shapes, causes: Sequence[Hypothesis], alpha: float, seed: int = 0
) -> Limits:
    """Limits by drawing records of a rig with nothing wrong but its commissioning errors.

    The draws have the same recordings, dates, noise and shared errors, and go through the same
    search over causes, shapes and dates, so that the rate is that of the whole search. A constant
    fault leaves the limit of a change as it is: the constant part of each cause is free.

    Args:
        joint: what the recordings tell.
        shapes: changes that are looked for.
        causes: the library.
        alpha: probability of a false alarm in the whole series.
        seed: of the draws.
    """
    rng, best = np.random.default_rng(seed), []
    count = int(np.ceil(BEYOND / alpha))
    for first in range(0, count, CHUNK):
        drawn = joint.draws(rng, min(CHUNK, count - first))
        found = scores(joint, shapes, causes, drawn)
        best.append([s.max(axis=1) for s in (found.change, found.varies, found.constant)])
    change, varies, constant = np.concatenate(best, axis=1)
    return Limits(
        alpha,
        float(np.quantile(change, 1.0 - 0.5 * alpha)),
        float(np.quantile(varies, 1.0 - 0.5 * alpha)),
        float(np.quantile(constant, 1.0 - alpha)),
    )
