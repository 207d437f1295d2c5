"""rungs: which sizes of a cause are simulated for a bank, and what the others are made of."""

from __future__ import annotations

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.forward import Hypothesis
from ves_twin.diagnosis.linearise import MANY

FEWER = "some sizes of single causes"
"""What is left out where the runs of a machine are dear."""


def rungs(hypothesis: Hypothesis, crowd: int) -> tuple[FloatArray, FloatArray]:
    """Departures to simulate, and how the traces of all sizes follow from theirs.

    What is linear is simulated once for each parameter, and scaled and added. Else a size that is
    not simulated is the nearest one of its sign, scaled: good enough to rank causes, since a fit
    simulates every size that it tries. Simulated are the second and the largest, or the middle
    alone where many targets have the same kind of cause. (Of 245 sizes of causes of VES II the
    middle alone ranks 242 first; it loses signals that are later than their own cycle, whose kinds
    have one target.)

    Args:
        hypothesis: the cause.
        crowd: how many causes of its library are of its kind.

    Returns:
        departures (m, parameters), and weights (k, m): entry k is the sum of weight times trace.
    """
    every = hypothesis.departures()
    count = len(hypothesis.parameters)
    if hypothesis.linear:
        sizes = hypothesis.signs[-1] * np.sort(np.abs(every), axis=0)[(2 * len(every)) // 3]
        return np.diag(sizes), every / sizes
    if hypothesis.starts or count > 1:
        return every, np.eye(len(every))
    picked: list[int] = []
    for sign in hypothesis.signs:
        side = np.flatnonzero(every[:, 0] * sign > 0)
        side = side[np.argsort(np.abs(every[side, 0]))]
        ends = {len(side) // 2} if crowd >= MANY else {min(1, len(side) - 1), len(side) - 1}
        picked += [int(side[n]) for n in sorted(ends)]
    asked = every[picked]
    with np.errstate(invalid="ignore"):
        apart = np.abs(np.log(every / asked.T))  # of another sign: not a number
    nearest = np.nanargmin(apart, axis=1)
    weights = np.zeros((len(every), len(asked)))
    weights[np.arange(len(every)), nearest] = every[:, 0] / asked[nearest, 0]
    return asked, weights
