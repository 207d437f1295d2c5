"""Friction of a joint that depends on more than the sign of its speed."""

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
from ves_twin.effects.size import EFFORT, SPEED, Size


@final
@dataclass(frozen=True)
class QuadraticDrag(Effect):
    """Resistance with the square of speed: an effort drag * v * |v|.

    Above zero a fan or a fluid; below it viscous friction grows less than in proportion to speed,
    as that of warm grease and of harmonic drives does.
    """

    drag: float = 0.0

    kind = "quadratic_drag"
    sizes = (Size("drag", ("N*s^2/m^2", "N*m*s^2/rad^2")),)
    anywhere = Anywhere(Element.JOINT, lambda p: 3.0 * p.effort / p.speed**2)

    @property
    def resistance(self) -> Resistance:
        """The drag times speed and its size."""
        return Resistance(Form.BY_SQUARE, (self.drag,))


@final
@dataclass(frozen=True)
class StribeckFriction(Effect):
    """Dry friction that falls with speed: level * exp(-(v / fall)^2) * sign(v).

    Beside Coulomb friction at the same joint it is the part that boundary lubrication adds.

    Source: Armstrong-Helouvry 1991, Control of Machines with Friction, with the Gaussian form.
    """

    level: float = 0.0
    fall: float = 0.0

    kind = "stribeck_friction"
    sizes = (Size("level", EFFORT), Size("fall", SPEED, Sign.POSITIVE))
    anywhere = Anywhere(Element.JOINT)

    @classmethod
    def magnitudes_at(cls, place: Place) -> tuple[Magnitude, ...]:
        """Up to the typical effort, over up to the typical speed; both signs: it may rise."""
        return cls.ranged(place, place.effort, place.speed)

    @classmethod
    def starts(cls, place: Place) -> tuple[tuple[float, ...], ...]:
        """A tenth of the typical effort, more or less, over 3, 10, 30 % of the typical speed."""
        grid = product((0.1, -0.1), (0.03, 0.1, 0.3))
        return tuple((level * place.effort, fall * place.speed) for level, fall in grid)

    @property
    def resistance(self) -> Resistance:
        """The level where the joint is slow, gone where it is fast."""
        return Resistance(Form.FALLING, (self.level, self.fall))


@final
@dataclass(frozen=True)
class RegularizedFriction(Effect):
    """Dry friction that sets in over a speed: level * tanh(v / transition).

    Greased gears, and torques that are read from a current behind a filter: near a reversal they
    have no sharp sign. Far below the transition it is viscous, far above Coulomb friction.

    Source: Andersson, Soderberg and Bjorklund 2007, Friction models for sliding dry, boundary and
    mixed lubricated contacts, with the hyperbolic tangent.
    """

    level: float = 0.0
    transition: float = 0.0

    kind = "regularized_friction"
    sizes = (Size("level", EFFORT, Sign.POSITIVE), Size("transition", SPEED, Sign.POSITIVE))
    anywhere = Anywhere(Element.JOINT)

    @classmethod
    def magnitudes_at(cls, place: Place) -> tuple[Magnitude, ...]:
        """Up to the typical effort, over up to the typical speed."""
        return cls.ranged(place, place.effort, place.speed)

    @classmethod
    def starts(cls, place: Place) -> tuple[tuple[float, ...], ...]:
        """A tenth of the typical effort over 1, 3, 10, 30 % of the typical speed."""
        return tuple((0.1 * place.effort, s * place.speed) for s in (0.01, 0.03, 0.1, 0.3))

    @property
    def resistance(self) -> Resistance:
        """The level, less where the joint is slower than the transition."""
        return Resistance(Form.SMOOTHED, (self.level, self.transition))


@final
@dataclass(frozen=True)
class LoadFriction(Effect):
    """Dry friction that grows with the load: share * |load| * sign(v), as in gears and seals.

    The load is the effort that the joint carries without its own friction.

    Source: Hamon, Gautier and Garrec 2010, Dynamic identification of robots with a dry friction
    model depending on load and velocity.
    """

    share: float = 0.0

    kind = "load_friction"
    sizes = (Size("share", "1", Sign.POSITIVE),)
    # a worm gear that can just be turned from its output side loses half
    anywhere = Anywhere(Element.JOINT, 0.5, 0.002, source="assumed: a worm gear loses half")

    @property
    def resistance(self) -> Resistance:
        """The share of the load's size, against the motion."""
        return Resistance(Form.BY_LOAD, (self.share,))
