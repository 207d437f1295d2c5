"""same_programme: whether two recordings were given the same set-points."""

from __future__ import annotations

import numpy as np

from ves_twin.core.quantity import quantity
from ves_twin.core.signals import SIGNALS
from ves_twin.machines.ves2.prepared import Prepared

COUNTS = {"m": 2e-6, "rad": 2e-5}
"""Set-points may differ by so much: four counts of a transducer, a fifth of one of an encoder."""


def same_programme(one: Prepared, other: Prepared, count: int) -> str:
    """What differs between the set-points of two recordings, in words; empty if nothing does.

    The gravity estimate is not asked: it answers to the run.

    Args:
        one: a recording.
        other: another one at the same rate.
        count: rows that both have.
    """
    for name in one.drive:
        if name == "gravity.estimate":
            continue
        if name not in other.recording.signals:
            return f"it has no {name}"
        gap = np.abs(one.recording[name][:count] - other.recording[name][:count]).max(axis=0)
        for column, unit, value in zip(
            SIGNALS[name].columns, SIGNALS[name].units, gap, strict=True
        ):
            if value > COUNTS[unit]:
                return f"{column} differs by up to {quantity(float(value), unit)}"
    return ""
