"""one_rig: whether all recordings agree on the machine that made them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ves_twin.core.types import FloatArray

NAMED = 3
"""Parameters that are told where recordings do not agree."""


@dataclass(frozen=True)
class Sharing:
    """Information of one recording on the shared parameters, in commissioning sd."""

    information: FloatArray
    score: FloatArray


@dataclass(frozen=True)
class Differs:
    """One parameter on which recordings do not agree.

    Attributes:
        parameter: its name.
        sds: how far each recording has it from nominal, in declared sd (n,); where a recording
            tells little, near zero.
        chi2: that a value of its own on each day takes away.
    """

    parameter: str
    sds: tuple[float, ...]
    chi2: float


@dataclass(frozen=True)
class OneRig:
    """Whether one machine in one state, up to the cause that is followed, made all recordings.

    Attributes:
        statistic: chi^2 by which a machine for each recording fits better than one for all.
        threshold: that one machine passes with the stated probability.
        differs: what differs most, where it is passed.
        groups: numbers of the recordings that go together by the first of them, two groups.
    """

    statistic: float
    threshold: float
    differs: tuple[Differs, ...] = ()
    groups: tuple[tuple[int, ...], ...] = ()

    @property
    def agrees(self) -> bool:
        """Whether it may be one machine."""
        return self.statistic <= self.threshold


def one_rig(days: Sequence[Sharing], names: Sequence[str], alpha: float, seed: int = 0) -> OneRig:
    """Hold recordings against each other.

    One machine is x ~ N(0, 1), in commissioning sd. Machines that differ are x + d_k, d_k ~ N(0, 1)
    on each day. Of information (L_k, g_k), Q is the chi^2 by which the most probable d_k fit better
    than none:

        Q = sum g_k'(I + L_k)^-1 g_k + h'(I + sum L_k (I + L_k)^-1)^-1 h - g'(I + L)^-1 g,

    h = sum (I + L_k)^-1 g_k, g and L the sums. Its threshold is that of drawn machines, each with
    all recordings.

    Args:
        days: what each recording tells.
        names: of the parameters.
        alpha: probability that one machine passes the threshold.
        seed: of the draws.
    """
    count = int(np.ceil(100 / alpha))
    if not names or len(days) < 2:
        return OneRig(0.0, 0.0)
    rng, p = np.random.default_rng(seed), len(names)
    truth = rng.standard_normal((count, p))
    drawn = []
    for day in days:
        values, vectors = np.linalg.eigh(day.information)
        root = vectors * np.sqrt(np.maximum(values, 0.0))
        drawn.append(truth @ day.information + rng.standard_normal((count, p)) @ root.T)
    threshold = float(np.quantile(_excess(days, drawn), 1.0 - alpha))
    found = float(_excess(days, [day.score[None] for day in days])[0])
    if found <= threshold:
        return OneRig(found, threshold)
    differs = _differs(days, names)
    return OneRig(found, threshold, differs, _groups(differs[0].sds))


def _excess(days: Sequence[Sharing], scores: Sequence[FloatArray]) -> FloatArray:
    """Q for rows of scores (r, p) of each recording."""
    one = np.eye(days[0].information.shape[0])
    total, whole = np.sum(scores, axis=0), one + np.sum([d.information for d in days], axis=0)
    apart, rest, loose = np.zeros(len(total)), np.zeros_like(total), one.copy()
    for day, g in zip(days, scores, strict=True):
        own = np.linalg.solve(one + day.information, g.T).T
        apart += np.einsum("ri,ri->r", g, own)
        rest += own
        loose += np.linalg.solve(one + day.information, day.information)
    apart += np.einsum("ri,ri->r", rest, np.linalg.solve(loose, rest.T).T)
    return np.asarray(apart - np.einsum("ri,ri->r", total, np.linalg.solve(whole, total.T).T))


def _differs(days: Sequence[Sharing], names: Sequence[str]) -> tuple[Differs, ...]:
    """Parameters by what a value of their own on each day would take away, all others shared."""
    one = np.eye(len(names))
    whole = np.linalg.inv(one + np.sum([day.information for day in days], axis=0))
    mean = whole @ np.sum([day.score for day in days], axis=0)
    found = []
    for i, name in enumerate(names):
        left = np.array([d.score[i] - d.information[i] @ mean for d in days])
        rows = np.array([d.information[i] for d in days])
        power = np.diag([d.information[i, i] for d in days]) - rows @ whole @ rows.T
        shift = np.linalg.solve(power + np.eye(len(days)), left)
        found.append(Differs(name, tuple(float(mean[i] + s) for s in shift), float(left @ shift)))
    return tuple(sorted(found, key=lambda d: -d.chi2)[:NAMED])


def _groups(sds: Sequence[float]) -> tuple[tuple[int, ...], ...]:
    """Two groups, parted at the widest gap between values in order."""
    order = np.argsort(sds)
    cut = int(np.argmax(np.diff(np.array(sds)[order]))) + 1
    low, high = sorted(map(int, order[:cut])), sorted(map(int, order[cut:]))
    return tuple(sorted((tuple(low), tuple(high))))
