"""Friction of a joint that remembers where it has been: behind a gap, one way, before it slides."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import final

from ves_twin.effects.effect import Effect
from ves_twin.effects.element import Element
from ves_twin.effects.magnitude import Magnitude, Sign
from ves_twin.effects.place import Place
from ves_twin.effects.resistance import Form, Resistance
from ves_twin.effects.row import Anywhere
from ves_twin.effects.size import EFFORT, LENGTH, Size

LEAST_TRAVEL = 1e-6
"""Smallest elastic travel [m, rad]: below it friction is as rigid as a sign."""


@final
@dataclass(frozen=True)
class FrictionBehindGap(Effect):
    """Dry friction behind a spring and a gap: a Jenkins element with lost motion.

    Between joint and slider lie a gap g and an elastic travel e. The slider stands while the
    effort stays within level * (1 + difference) forward and level * (1 - difference) backward:

        u = x - slider;  w = (u - sign(u) min(|u|, g/2)) / e;  effort = level * clip(w)

    and follows where w would leave that range. gap = 0 is the plain Jenkins element; travel -> 0
    is Coulomb friction.

    Source: Jenkins 1962, Analysis of the stress-strain relationships in reactor grade graphite.
    """

    level: float = 0.0
    difference: float = 0.0
    travel: float = 0.0
    gap: float = 0.0

    kind = "friction_behind_gap"
    sizes = (
        Size("level", EFFORT, Sign.POSITIVE),
        Size("difference", "1"),
        Size("travel", LENGTH, Sign.POSITIVE),
        Size("gap", LENGTH, Sign.POSITIVE),
    )
    anywhere = Anywhere(Element.JOINT)

    @classmethod
    def magnitudes_at(cls, place: Place) -> tuple[Magnitude, ...]:
        """Level up to twice the typical effort; travel and gap up to the typical travel."""
        return cls.ranged(place, 2.0 * place.effort, 0.6, place.travel, place.travel)

    @classmethod
    def starts(cls, place: Place) -> tuple[tuple[float, ...], ...]:
        """Half the typical effort; travels and gaps each twice the last one, three differences."""
        travels, gaps = (0.01, 0.02, 0.04, 0.08, 0.16), (0.0, 0.02, 0.04, 0.08, 0.16, 0.32)
        grid, reach = product((-0.25, 0.0, 0.25), travels, gaps), place.travel
        return tuple((0.5 * place.effort, d, e * reach, g * reach) for d, e, g in grid)

    @property
    def resistance(self) -> Resistance:
        """Of a motion that begins with the slider in the middle of the gap."""
        travel = max(self.travel, LEAST_TRAVEL)
        return Resistance(Form.SLIDER, (self.level, self.difference, travel, self.gap))


@final
@dataclass(frozen=True)
class OneWayLoad(Effect):
    """A load that resists motion one way, holds where the joint stands, and lets it go back free.

    A cylinder against a relief valve behind a check valve, a weight on a ratchet. It sets in over
    an elastic travel e, and is gone e behind where the motion turned: a Jenkins element whose
    effort stays within 0 and load. Above zero it resists motion in the joint's positive direction.
    """

    load: float = 0.0
    travel: float = 0.0

    kind = "one_way_load"
    sizes = (Size("load", EFFORT), Size("travel", LENGTH, Sign.POSITIVE))
    anywhere = Anywhere(Element.JOINT)

    @classmethod
    def magnitudes_at(cls, place: Place) -> tuple[Magnitude, ...]:
        """Load up to twice the typical effort, over up to half the typical travel."""
        return cls.ranged(place, 2.0 * place.effort, 0.5 * place.travel)

    @classmethod
    def starts(cls, place: Place) -> tuple[tuple[float, ...], ...]:
        """Half the typical effort either way, over travels each four times the last one."""
        grid = product((0.5, -0.5), (0.002, 0.008, 0.032))
        return tuple((load * place.effort, e * place.travel) for load, e in grid)

    @property
    def resistance(self) -> Resistance:
        """A slider with twice half the load on one side, none on the other."""
        side, travel = 1.0 if self.load > 0.0 else -1.0, max(0.5 * self.travel, LEAST_TRAVEL)
        return Resistance(Form.SLIDER, (0.5 * abs(self.load), side, travel))


@final
@dataclass(frozen=True)
class DahlFriction(Effect):
    """Dry friction that sets in over a travel, and remembers: Dahl's, of exponent one.

    With F the effort against the joint and e the elastic travel, level / e the stiffness at rest,

        dF/dx = level / e * (1 - sign(dx) F / level)

    so that between two positions F nears +-level as exp(-|dx| / e), whatever the speed. Contacts
    that creep before they slip: rolling bearings, seals, roller guides. travel -> 0 is Coulomb
    friction.

    Source: Dahl 1968, A solid friction model, Aerospace Corporation TOR-0158(3107-18)-1.
    """

    level: float = 0.0
    travel: float = 0.0

    kind = "dahl_friction"
    sizes = (Size("level", EFFORT, Sign.POSITIVE), Size("travel", LENGTH, Sign.POSITIVE))
    anywhere = Anywhere(Element.JOINT)

    @classmethod
    def magnitudes_at(cls, place: Place) -> tuple[Magnitude, ...]:
        """Level up to twice the typical effort, over up to half the typical travel."""
        return cls.ranged(place, 2.0 * place.effort, 0.5 * place.travel)

    @classmethod
    def starts(cls, place: Place) -> tuple[tuple[float, ...], ...]:
        """A tenth of the typical effort over travels each four times the last one."""
        return tuple((0.1 * place.effort, e * place.travel) for e in (0.0005, 0.002, 0.008, 0.032))

    @property
    def resistance(self) -> Resistance:
        """Of a motion that begins unloaded."""
        return Resistance(Form.CREEPING, (self.level, max(self.travel, LEAST_TRAVEL)))
