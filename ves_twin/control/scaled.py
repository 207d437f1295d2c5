"""ScaledCompensation: a gravity estimate that is wrong by a share of itself, on purpose."""

from __future__ import annotations

from typing import final

from ves_twin.control.gravity import GravityCompensation
from ves_twin.control.gravity_law import scaled_law
from ves_twin.control.law_of import law_of
from ves_twin.control.readings import Readings
from ves_twin.core.types import Block, FloatArray


@final
class ScaledCompensation(GravityCompensation):
    """Another compensation's estimate times 1 + share: M_total and P wrong by that share.

    Args:
        exact: the other compensation.
        share: relative error.
        since: time from which on it is wrong [s]; None: also while the sensor is zeroed.
    """

    def __init__(self, exact: GravityCompensation, share: float, since: float | None) -> None:
        self._exact, self._factor, self._since = exact, 1.0 + share, since
        self.subtracts = exact.subtracts
        self._law = scaled_law(law_of(exact), self._factor, since)

    @property
    def law(self) -> Block | None:
        """The other compensation's, scaled."""
        return self._law

    def wrench(self, time: float, readings: Readings) -> FloatArray:
        """The estimate, and from `since` on the wrong one, sensor axes [N, N m] (6,)."""
        estimate = self._exact.wrench(time, readings)
        right = self._since is not None and time < self._since
        return estimate if right else self._factor * estimate

    def snapshot(self) -> object:
        """What the other compensation keeps."""
        return self._exact.snapshot()

    def restore(self, snapshot: object) -> None:
        """Give it back."""
        self._exact.restore(snapshot)
