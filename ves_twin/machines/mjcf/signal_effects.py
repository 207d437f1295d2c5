"""Effects of a recorded signal: gain, offset, drift, cross-talk, delay."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, final

import numpy as np
from numpy.polynomial.legendre import legvander

from ves_twin.core.types import FloatArray
from ves_twin.effects.magnitude import Magnitude
from ves_twin.machines.mjcf.effect import RigEffect, shifted
from ves_twin.machines.mjcf.element import Element
from ves_twin.machines.mjcf.part_effects import DELAY
from ves_twin.machines.mjcf.place import Place
from ves_twin.machines.mjcf.size import Size


@final
@dataclass(frozen=True)
class SensorGain(RigEffect):
    """One column reads (1 + gain) times what is there."""

    gain: float = 0.0

    kind: ClassVar[str] = "sensor_gain"
    element: ClassVar[Element] = Element.SIGNAL
    size: ClassVar[Size] = Size("gain", "1", 0.3, 0.001)
    linear: ClassVar[bool] = True

    def edit_reading(
        self, reading: FloatArray, true: FloatArray, time: FloatArray, place: Place
    ) -> FloatArray:
        """Add its share of the true value."""
        return _added(reading, self.column, self.gain * true[:, self.column])


@final
@dataclass(frozen=True)
class CrossTalk(RigEffect):
    """One column reads a share of another one; target "wrist.force.3.1": column 3 reads 1."""

    share: float = 0.0

    kind: ClassVar[str] = "cross_talk"
    element: ClassVar[Element] = Element.SIGNAL
    size: ClassVar[Size] = Size("share", "1", 0.2, 0.001)
    linear: ClassVar[bool] = True

    def edit_reading(
        self, reading: FloatArray, true: FloatArray, time: FloatArray, place: Place
    ) -> FloatArray:
        """Add its share of the other column."""
        to, of = (int(number) - 1 for number in self.target.split(".")[-2:])
        return _added(reading, to, self.share * true[:, of])


@final
@dataclass(frozen=True)
class SensorOffset(RigEffect):
    """One column reads off by a constant."""

    offset: float = 0.0

    kind: ClassVar[str] = "sensor_offset"
    element: ClassVar[Element] = Element.SIGNAL
    size: ClassVar[Size] = Size("offset", "", lambda p: 3.0 * p.span)
    linear: ClassVar[bool] = True

    def edit_reading(
        self, reading: FloatArray, true: FloatArray, time: FloatArray, place: Place
    ) -> FloatArray:
        """Add the offset."""
        return _added(reading, self.column, self.offset)


@final
@dataclass(frozen=True)
class SensorDrift(RigEffect):
    """One column wanders slowly: sum of p_k P_k(s), s from -1 to 1 over the file's stretch.

    P_k are Legendre polynomials from the first order on; the constant is an offset. The shape is
    of that stretch: between its rows it can be filled in, beyond its end it says nothing.
    """

    p1: float = 0.0
    p2: float = 0.0
    p3: float = 0.0
    p4: float = 0.0
    p5: float = 0.0
    p6: float = 0.0

    kind: ClassVar[str] = "sensor_drift"
    element: ClassVar[Element] = Element.SIGNAL
    linear: ClassVar[bool] = True
    transient: ClassVar[bool] = True

    @classmethod
    def magnitudes(cls, place: Place) -> tuple[Magnitude, ...]:
        """Up to the typical range each."""
        size = (0.0, 0.0002 * place.span, place.span)
        return tuple(Magnitude(f"p{k + 1}", place.unit, *size) for k in range(place.terms))

    def edit_reading(
        self, reading: FloatArray, true: FloatArray, time: FloatArray, place: Place
    ) -> FloatArray:
        """Add the wander."""
        s = 2.0 * (time - place.begin) / (place.end - place.begin) - 1.0
        weights = np.array([0.0, *self.sizes.values()])
        return _added(reading, self.column, legvander(s, len(weights) - 1) @ weights)


@final
@dataclass(frozen=True)
class SensorDelay(RigEffect):
    """A whole signal is read late."""

    delay: float = 0.0

    kind: ClassVar[str] = "sensor_delay"
    element: ClassVar[Element] = Element.SIGNAL
    size: ClassVar[Size] = DELAY

    def edit_reading(
        self, reading: FloatArray, true: FloatArray, time: FloatArray, place: Place
    ) -> FloatArray:
        """What was read a delay ago."""
        return shifted(reading, time, self.delay)


def _added(reading: FloatArray, column: int, change: FloatArray | float) -> FloatArray:
    """A reading (n, w) with something added to one column."""
    reading = reading.copy()
    reading[:, column] += change
    return reading
