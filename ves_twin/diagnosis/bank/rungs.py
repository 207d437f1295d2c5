"""rungs: which sizes of a cause are simulated for a bank, and what the others are made of."""

from __future__ import annotations

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.bank.linearise import MANY
from ves_twin.diagnosis.model.forward import Hypothesis

MIRROR = np.log(2.0)
"""What another sign counts beside the logarithm of two sizes' ratio, where it may stand in."""

FEWER = "some sizes of single causes"
"""What is left out where the runs of a machine are dear."""


def rungs(
    hypothesis: Hypothesis, crowd: int, known: FloatArray | None = None
) -> tuple[FloatArray, FloatArray]:
    """Departures to simulate, and how the traces of all sizes follow from theirs.

    What is linear is simulated once for each parameter, and scaled and added. Else a size that is
    not simulated is the nearest one of its sign, scaled: good enough to rank causes, since a fit
    simulates every size that it tries. Simulated are the second and the largest, or the middle
    alone where many targets have the same kind of cause. (Of 245 sizes of causes of VES II the
    middle alone ranks 242 first; it loses signals that are later than their own cycle, whose kinds
    have one target.)

    A bank knows more: what one sd of a commissioning parameter changes, which stands for small
    sizes. There the smallest size of one sign stands for those of both, but for the largest of the
    other where few causes are of its kind. (Of 128 sizes of gains, lags, air, hoses and tilts of
    VES II 127 rank first then, 128 with twice as many runs; the other, of a gain of all legs of
    40 %, third.)

    Args:
        hypothesis: the cause.
        crowd: how many causes of its library are of its kind.
        known: sizes of its parameters whose traces a bank has already, of all of them or of none
            (parameters,) or (0,); None where this is for no bank.

    Returns:
        departures (m, parameters), and weights (k, m or m + parameters), known traces last: entry k
        is the sum of weight times trace.
    """
    every = hypothesis.departures()
    count, given = len(hypothesis.parameters), np.zeros(0) if known is None else known
    if hypothesis.linear and len(given):
        return np.zeros((0, count)), every / given
    if hypothesis.linear:
        sizes = hypothesis.signs[-1] * np.sort(np.abs(every), axis=0)[(2 * len(every)) // 3]
        return np.diag(sizes), every / sizes
    if hypothesis.starts or count > 1:
        return every, np.pad(np.eye(len(every)), ((0, 0), (0, len(given))))
    sizes = every[:, 0]
    picked = _picked(hypothesis, sizes, crowd >= MANY, known)
    traces = np.concatenate([sizes[picked], given])
    other = np.sign(sizes)[:, None] != np.sign(traces)
    apart = np.abs(np.log(np.abs(sizes[:, None] / traces))) + np.where(other, MIRROR, 0.0)
    if known is None:
        apart[other] = np.inf
    nearest = np.argmin(apart, axis=1)
    weights = np.zeros((len(sizes), len(traces)))
    weights[np.arange(len(sizes)), nearest] = sizes / traces[nearest]
    return every[picked], weights


def _picked(
    hypothesis: Hypothesis, sizes: FloatArray, many: bool, known: FloatArray | None
) -> list[int]:
    """Which sizes (k,) are simulated."""
    found: list[int] = []
    for sign in hypothesis.signs:
        side = np.flatnonzero(sizes * sign > 0)
        side = side[np.argsort(np.abs(sizes[side]))]
        last, middle = len(side) - 1, len(side) // 2
        ends = {middle} if many else {min(1, last), last}
        if known is not None and len(known):  # that one is small
            ends = {middle if many else last}
        elif known is not None and len(hypothesis.signs) > 1:
            ends = {0} if sign == hypothesis.signs[-1] else set() if many else {last}
        found += [int(side[n]) for n in sorted(ends)]
    return found
