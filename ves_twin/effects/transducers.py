"""Effects of VES II's leg transducers: offset, scale, delay."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

from ves_twin.effects.change import Law, Loop
from ves_twin.effects.effect import Effect
from ves_twin.effects.magnitude import Sign
from ves_twin.effects.row import LEGS, Part, Row
from ves_twin.effects.size import Size

READ_AND_FELT = ("leg.length", "sensor.wrench")


@final
@dataclass(frozen=True)
class LengthOffset(Effect):
    """A transducer reads too long by a constant: L -> L + offset."""

    offset: float = 0.0

    kind = "length_offset"
    sizes = (Size("offset", "m"),)
    source = "assumed; zeroing against a gauge leaves about 0.1 mm"
    rows = (Row(LEGS, (1e-4, 3e-4, 0.02), READ_AND_FELT, Loop("transducer.home"), Part.TRANSDUCER),)


@final
@dataclass(frozen=True)
class LengthScale(Effect):
    """A transducer reads too long in proportion to the travel from home: q -> (1 + scale) q."""

    scale: float = 0.0

    kind = "length_scale"
    sizes = (Size("scale", "1"),)
    source = "assumed; the speed of the strain pulse is known to about 0.05 %"
    rows = (
        Row(
            LEGS,
            (5e-4, 1e-3, 0.05),
            READ_AND_FELT,
            Loop("transducer.scale", Law.SCALE),
            Part.TRANSDUCER,
        ),
    )


@final
@dataclass(frozen=True)
class TransducerDelay(Effect):
    """A transducer reads where its rod was: L(t) -> L(t - delay).

    The leg loop feels it as it feels a delay of that leg's valve, so that lengths alone part the
    two only by the legs that take part.
    """

    delay: float = 0.0

    kind = "transducer_delay"
    sizes = (Size("delay", "s", Sign.POSITIVE),)
    source = "thesis 2.4.1 and errata E-5: the cards' update time was printed wrong"
    proportional = False
    rows = (
        Row(
            LEGS,
            (0.0, 5e-4, 0.02),
            ("leg.length", "valve.command"),
            Loop("late.slide.delay"),
            Part.CLOCK,
        ),
    )
