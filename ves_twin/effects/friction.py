"""Friction of a joint that depends on more than the sign of its speed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product
from typing import final

import numpy as np

from ves_twin.core.compiled import compiled
from ves_twin.core.types import FloatArray
from ves_twin.effects.effect import Effect
from ves_twin.effects.element import Element
from ves_twin.effects.magnitude import Magnitude, Sign
from ves_twin.effects.place import Place
from ves_twin.effects.row import Anywhere
from ves_twin.effects.size import EFFORT, LENGTH, SPEED, Size

LEAST_TRAVEL = 1e-6
"""Smallest elastic travel of a Jenkins element [m, rad]: below it, it is as rigid as a sign."""


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

    def resist(self, speed: FloatArray, slow: float) -> FloatArray:
        """The drag times speed and its size."""
        return np.asarray(self.drag * speed * np.abs(speed))


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

    def resist(self, speed: FloatArray, slow: float) -> FloatArray:
        """The level where the joint is slow, gone where it is fast."""
        if self.fall <= 0.0:
            return np.zeros_like(speed)
        return np.asarray(
            self.level * np.exp(-np.square(speed / self.fall)) * np.tanh(speed / slow)
        )


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

    def resist(self, speed: FloatArray, slow: float) -> FloatArray:
        """The level, less where the joint is slower than the transition."""
        return np.asarray(self.level * np.tanh(speed / max(self.transition, slow)))


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

    def carry(self, load: FloatArray, speed: FloatArray, slow: float) -> FloatArray:
        """The share of the load's size, against the motion."""
        return np.asarray(self.share * np.abs(load) * np.tanh(speed / slow))


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

    def hold(self, position: FloatArray) -> FloatArray:
        """The effort along a motion that begins with the slider in the middle of the gap."""
        if self.level == 0.0:
            return np.zeros_like(position)
        return np.asarray(self.level * _jenkins(np.asarray(position, float), *self._shape))

    def holder(self) -> Callable[[float], float]:
        """The same, position by position."""
        slider: list[float] = []

        def effort(position: float) -> float:
            if not slider:
                slider.append(position)
            share, slider[0] = _slip(position, slider[0], *self._shape)
            return self.level * share

        return effort

    @property
    def _shape(self) -> tuple[float, float, float]:
        return self.difference, max(self.travel, LEAST_TRAVEL), self.gap


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

    def hold(self, position: FloatArray) -> FloatArray:
        """The effort along a motion that begins unloaded."""
        return self._element.hold(np.asarray(position, float))

    def holder(self) -> Callable[[float], float]:
        """The same, position by position."""
        return self._element.holder()

    @property
    def _element(self) -> FrictionBehindGap:
        """Twice half the load on one side, none on the other."""
        side = 1.0 if self.load > 0.0 else -1.0
        return FrictionBehindGap(self.target, 0.5 * abs(self.load), side, 0.5 * self.travel)


@compiled
def _slip(
    position: float, slider: float, difference: float, travel: float, gap: float
) -> tuple[float, float]:
    """Share of the level, and where the slider is then."""
    apart = position - slider
    half = 0.5 * gap
    strain = apart - half if apart > half else (apart + half if apart < -half else 0.0)
    share = strain / travel
    forward, back = 1.0 + difference, -(1.0 - difference)
    if share > forward:
        return forward, slider + (share - forward) * travel
    if share < back:
        return back, slider + (share - back) * travel
    return share, slider


@compiled
def _jenkins(position: FloatArray, difference: float, travel: float, gap: float) -> FloatArray:
    """Share of the level at each position (n,)."""
    shares = np.empty_like(position)
    slider = position[0]
    for k in range(len(position)):
        shares[k], slider = _slip(position[k], slider, difference, travel, gap)
    return shares
