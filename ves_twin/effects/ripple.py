"""Ripple: effort of a joint that comes and goes with its position, so many times a turn."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import final

from ves_twin.core.errors import InvalidInputError
from ves_twin.effects.effect import Effect
from ves_twin.effects.element import Element
from ves_twin.effects.resistance import Form, Resistance
from ves_twin.effects.row import Anywhere
from ves_twin.effects.size import EFFORT, Size

NUMBERED = re.compile(r"(.+?)\.(\d+(?:\.\d+)?)")


@final
@dataclass(frozen=True)
class Ripple(Effect):
    """Ripple of gears, cogging of a motor: an effort cosine * cos(n q) + sine * sin(n q).

    The target says n: "axis.320" has 320 waves a turn, known from the gearing or the motor's poles.
    So both sizes are linear, and a joint may have several ripples. On a slide n is in rad/m: poles
    32 mm apart make "rail.196.35".

    Source: Armstrong-Helouvry 1991, Control of Machines with Friction, on position-dependent
    friction; Holtz and Springob 1996, Identification and compensation of torque ripple.
    """

    cosine: float = 0.0
    sine: float = 0.0

    kind = "ripple"
    sizes = (Size("cosine", EFFORT, component=True), Size("sine", EFFORT, component=True))
    anywhere = Anywhere(Element.JOINT, lambda p: 0.5 * p.effort)

    @property
    def parts(self) -> tuple[str, ...]:
        """The joint."""
        return (self._told[1],)

    @property
    def resistance(self) -> Resistance:
        """The effort along a motion."""
        return Resistance(Form.WAVES, (self.cosine, self.sine, float(self._told[2])))

    @property
    def _told(self) -> re.Match[str]:
        """Joint and number of waves.

        Raises:
            InvalidInputError: a target without a number.
        """
        found = NUMBERED.fullmatch(self.target)
        if found is None:
            expected = "a joint and the waves a turn, as axis.320"
            raise InvalidInputError(f"target of {self.kind}", self.target, expected)
        return found
