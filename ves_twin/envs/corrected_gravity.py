"""CorrectedGravity: a gravity estimate with a correction that an environment's actions make."""

from __future__ import annotations

from typing import cast, final

import numpy as np

from ves_twin.control.gravity import GravityCompensation
from ves_twin.control.gravity_law import KNOWN_LAW, corrected_law
from ves_twin.control.law_of import law_of
from ves_twin.control.readings import Readings
from ves_twin.core.types import Block, FloatArray


@final
class CorrectedGravity(GravityCompensation):
    """Another compensation's estimate plus a wrench that is held until the next command.

    Attributes:
        correction: sensor axes [N, N m] (6,).

    Args:
        inner: the other compensation.
    """

    def __init__(self, inner: GravityCompensation) -> None:
        self._inner = inner
        self.subtracts = inner.subtracts
        self.correction = np.zeros(6)
        self._law = corrected_law(law_of(inner))

    @property
    def law(self) -> Block | None:
        """The other compensation's with the correction of now."""
        if self._law is not None and self._law is not KNOWN_LAW:
            self._law["correction"] = self.correction
        return self._law

    def wrench(self, time: float, readings: Readings) -> FloatArray:
        """The corrected estimate, sensor axes [N, N m] (6,)."""
        return self._inner.wrench(time, readings) + self.correction

    def snapshot(self) -> object:
        """The correction, and what the other compensation keeps."""
        return self.correction.copy(), self._inner.snapshot()

    def restore(self, snapshot: object) -> None:
        """Give both back."""
        correction, inner = cast("tuple[FloatArray, object]", snapshot)
        self.correction = correction.copy()
        self._inner.restore(inner)
