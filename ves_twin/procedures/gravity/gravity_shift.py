"""gravity_shift: how far an error of the gravity estimate moves the emulated base in Z."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ves_twin.core.recording.recording import Recording


@dataclass(frozen=True)
class GravityShift:
    """Motion in Z with the exact and with a wrong estimate of gravity.

    Attributes:
        peak: largest motion in Z with the exact estimate [m].
        shift: largest difference that the error makes while both runs last [m].
    """

    peak: float
    shift: float

    @property
    def ratio(self) -> float:
        """How many times the true motion the error's is; not a number without a motion."""
        return self.shift / self.peak if self.peak > 0.0 else float("nan")


def gravity_shift(exact: Recording, wrong: Recording) -> GravityShift:
    """The shift between two runs of an experiment that differ in the gravity estimate alone.

    Source: thesis 3.2.2, Fig. 3-2.
    """
    rows = min(len(exact), len(wrong))
    if rows == 0:
        return GravityShift(float("nan"), float("nan"))
    z = exact["truth.pose"][:, 2]
    shift = wrong["truth.pose"][:rows, 2] - z[:rows]
    return GravityShift(float(np.max(np.abs(z - z[0]))), float(np.max(np.abs(shift))))
