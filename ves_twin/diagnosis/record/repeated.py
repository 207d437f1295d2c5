"""repeated, moved_alike, lag_of: how nearly one programme, moved in time, is another again."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from scipy.signal import correlate, detrend

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.model.forward import Excitation

Alike = Callable[[FloatArray, FloatArray], bool]
"""Whether two columns (n,) are one."""

REPEATS = 0.02
"""Difference of two measured inputs, of their range, up to which a motion counts as repeated: what
the difference does is taken off by the model, which is right to a few per cent of it."""

ALIKE = 0.05
"""Rms difference of two motions, of their spread, up to which one is the other again: of two
swing-ups of a cart by one programme 2.0 and 2.5 %, whose switched currents differ by 18 %."""

MIDDLE = 0.1
"""Share of a programme at either end that is not looked for in another one: two recordings of one
motion hardly ever begin and end in the same row."""


def repeated(held: Sequence[Excitation], fitted: Sequence[Excitation]) -> bool:
    """Whether all programmes that are held out are found in what is fitted, moved in time.

    What is proved on such a one is proved for that motion.

    Args:
        held: what was fed in while held-out recordings were made.
        fitted: the same of those that are fitted.
    """
    return _all_in(held, fitted, lambda one, other: apart(one, other) < REPEATS)


def moved_alike(held: Sequence[Excitation], fitted: Sequence[Excitation]) -> bool:
    """The same of what was measured: one motion, whatever the commands that made it."""
    return _all_in(held, fitted, _near)


def _near(one: FloatArray, other: FloatArray) -> bool:
    """Of columns with empty cells nothing is said."""
    if not np.all(np.isfinite([one, other])):
        return False
    one, other = detrend(one), detrend(other)  # two wheels turn alike, and differ beside that
    return bool(np.std(one - other) < ALIKE * np.std(other))


def _all_in(held: Sequence[Excitation], fitted: Sequence[Excitation], alike: Alike) -> bool:
    return bool(held) and all(any(_found_in(one, other, alike) for other in fitted) for one in held)


def _found_in(held: Excitation, fitted: Excitation, alike: Alike) -> bool:
    """Whether the middle of a programme is in another one of the same clock."""
    if held.poses or fitted.poses or not held.drive or held.drive.keys() != fitted.drive.keys():
        return False
    edge = int(MIDDLE * len(held.time))
    middle = {name: values[edge : len(values) - edge] for name, values in held.drive.items()}
    same_clock = abs(held.period - fitted.period) < MIDDLE * fitted.period
    lag = lag_of(fitted.drive, middle) if same_clock else None
    if lag is None:
        return False
    rows = slice(lag, lag + len(held.time) - 2 * edge)
    pairs = [
        (fitted.drive[name][rows, column], values[:, column])
        for name, values in middle.items()
        for column in range(values.shape[1])
        if _moves(values[:, column])
    ]
    return bool(pairs) and all(alike(one, other) for one, other in pairs)


def _moves(values: FloatArray) -> bool:
    """Whether a column (n,) is more than a constant and its noise."""
    return bool(np.std(np.diff(values)) < np.std(values))


def lag_of(given: Mapping[str, FloatArray], wanted: Mapping[str, FloatArray]) -> int | None:
    """Rows by which inputs are late, where they are nearest; None where they are too few."""
    total: FloatArray | None = None
    for name, values in wanted.items():
        longer, scale = given[name], max(float(np.ptp(values)), 1e-9)
        if longer.shape[1] != values.shape[1] or len(longer) < len(values):
            return None
        for column in range(values.shape[1]):
            x, y = longer[:, column] / scale, values[:, column] / scale
            middle = float(np.mean(y))
            x, y = x - middle, y - middle
            sums = np.cumsum(np.append(0.0, x**2))
            power = sums[len(y) :] - sums[: len(x) - len(y) + 1]
            apart = power - 2.0 * correlate(x, y, "valid")
            total = apart if total is None else total + apart
    return None if total is None else int(np.argmin(total))


def apart(one: FloatArray, two: FloatArray) -> float:
    """Largest difference, of the range of the second."""
    return float(np.abs(one - two).max()) / max(float(np.ptp(two)), 1e-9)
