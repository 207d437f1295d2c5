"""same_programme: whether two recordings were given the same set-points."""

from __future__ import annotations

import numpy as np

from ves_twin.core.quantity import quantity
from ves_twin.machines.case import Case


def same_programme(one: Case, other: Case, count: int) -> str:
    """What differs between the set-points of two recordings, in words; empty if nothing does.

    Inputs that answer to the run are not asked.

    Args:
        one: a recording.
        other: another one at the same rate.
        count: rows that both have.
    """
    for name, allowed in one.same.items():
        if name not in other.recording.signals:
            return f"it has no {name}"
        gap = np.abs(one.recording[name][:count] - other.recording[name][:count]).max(axis=0)
        signal = one.signals[name]
        for column, unit, value, most in zip(
            signal.columns, signal.units, gap, allowed, strict=True
        ):
            if value > most:
                return f"{column} differs by up to {quantity(float(value), unit)}"
    return ""
