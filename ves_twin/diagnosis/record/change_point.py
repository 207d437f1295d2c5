"""change_point: from which row on a residual is louder than before."""

from __future__ import annotations

import numpy as np

from ves_twin.core.types import FloatArray

LEAST = 8
"""Rows on either side: a mean of fewer squares says little."""

SURE = 12.0
"""Log-likelihood that a step must gain. Of 6000 draws of white noise none gained 9.5."""


def change_point(z: FloatArray) -> int | None:
    """The row at which the variance of a white series most likely rises; None where it does not.

    With S the sum of squares, a step at row k gains
    (n ln(S/n) - k ln(S_1/k) - (n - k) ln(S_2/(n - k))) / 2 nats over none.

    Args:
        z: whitened rows (n,) or (n, channels); NaN where there is none.
    """
    rows = z.reshape(len(z), -1)
    squares = np.nan_to_num(rows**2).sum(axis=1)
    counts = np.isfinite(rows).sum(axis=1)
    first, before = np.cumsum(squares)[:-1], np.cumsum(counts)[:-1]
    second, after = squares.sum() - first, counts.sum() - before
    able = (before >= LEAST) & (after >= LEAST) & (first > 0.0) & (second > 0.0)
    if not able.any():
        return None
    early, late = first[able] / before[able], second[able] / after[able]
    n, whole = counts.sum(), squares.sum() / counts.sum()
    gain = 0.5 * (n * np.log(whole) - before[able] * np.log(early) - after[able] * np.log(late))
    gain[late <= early] = -np.inf
    best = int(np.argmax(gain))
    return int(np.flatnonzero(able)[best]) + 1 if gain[best] > SURE else None
