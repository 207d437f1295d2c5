"""Effects of the leg length transducers: offset and scale."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, final

from ves_twin.effects.effect import LEGS, Effect
from ves_twin.effects.magnitude import Magnitude

if TYPE_CHECKING:
    import numpy as np


@final
@dataclass(frozen=True)
class LengthOffset(Effect):
    """A transducer reads too long by a constant: L -> L + offset."""

    offset: float = 0.0

    kind: ClassVar[str] = "length_offset"
    targets: ClassVar[tuple[str, ...]] = LEGS
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (Magnitude("offset", "m", 1e-4, 3e-4, 0.02),)
    channels: ClassVar[tuple[str, ...]] = ("leg.length", "sensor.wrench")
    source: ClassVar[str] = "assumed; zeroing against a gauge leaves about 0.1 mm"

    def edit_loop(self, parameters: np.void) -> None:
        """Shift the length at zero slide."""
        parameters["transducer"]["home"][self.index] += self.offset


@final
@dataclass(frozen=True)
class LengthScale(Effect):
    """A transducer reads too long in proportion to the travel from home: q -> (1 + scale) q."""

    scale: float = 0.0

    kind: ClassVar[str] = "length_scale"
    targets: ClassVar[tuple[str, ...]] = LEGS
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (Magnitude("scale", "1", 5e-4, 1e-3, 0.05),)
    channels: ClassVar[tuple[str, ...]] = ("leg.length", "sensor.wrench")
    source: ClassVar[str] = "assumed; the speed of the strain pulse is known to about 0.05 %"

    def edit_loop(self, parameters: np.void) -> None:
        """Scale the travel."""
        parameters["transducer"]["scale"][self.index] *= 1.0 + self.scale
