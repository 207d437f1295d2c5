"""Effects of a body: a point mass, its mass, place, centre of mass, inertia; and gravity."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, final

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.effects import change
from ves_twin.effects.effect import Effect
from ves_twin.effects.element import Element
from ves_twin.effects.magnitude import Magnitude, Sign
from ves_twin.effects.place import Place
from ves_twin.effects.row import LINKS, Anywhere, Part, Row
from ves_twin.effects.size import Size

if TYPE_CHECKING:
    import mujoco

LOAD = 3.0
"""What the last body of an arm may carry, in its own mass: tools are heavy. Assumed."""

LEFT = 0.01
"""Share of a body's mass and inertia that is left at least: MuJoCo takes neither at zero or below,
and a body next to nothing needs steps next to nothing."""

WEIGHED = ("sensor.wrench", "arm.torque")


@final
@dataclass(frozen=True)
class PayloadMass(Effect):
    """A point mass that nobody declared sits at the tool."""

    mass: float = 0.0

    kind = "payload_mass"
    sizes = (Size("mass", "kg", Sign.POSITIVE),)
    source = "assumed; tools and cables on the wrist"
    rows = (Row(("arm.tool",), (0.02, 0.05, 4.0), WEIGHED, part=Part.PAYLOAD),)

    def edit_arm(self, arm: mujoco.MjSpec) -> None:
        """Join the point mass to link 3, with centre of mass and inertia by the parallel axes."""
        if self.neutral:
            return
        _add_mass(arm, "link3", self.mass, np.asarray(arm.site("tip").pos))


@final
@dataclass(frozen=True)
class Payload(Effect):
    """A point mass that nobody declared sits on a body, at a place in its frame."""

    mass: float = 0.0
    x: float = 0.0
    y: float = 0.0
    z: float = 0.0

    kind = "payload"
    sizes = (
        Size("mass", "kg", Sign.POSITIVE),
        *(Size(axis, "m", component=True) for axis in "xyz"),
    )
    anywhere = Anywhere(Element.BODY, source="assumed: three times the body, up to 0.5 m away")

    @classmethod
    def magnitudes_at(cls, place: Place) -> tuple[Magnitude, ...]:
        """Up to three times the body, up to half a metre from its origin."""
        return cls.ranged(place, LOAD * place.mass, 0.5, 0.5, 0.5)

    @classmethod
    def starts(cls, place: Place) -> tuple[tuple[float, ...], ...]:
        """Half the body, at its origin and 0.1 m off along each axis."""
        places = 0.1 * np.vstack([np.zeros(3), np.eye(3), -np.eye(3)])
        return tuple((0.5 * place.mass, *at) for at in places.tolist())

    def edit_model(self, model: mujoco.MjModel) -> None:
        """Join the point mass to the body, by the parallel axes."""
        if self.mass == 0.0:
            return
        at = model.body(self.target).id
        centre, turn, inertia = model.body_ipos, model.body_iquat, model.body_inertia
        before = float(model.body_mass[at]), centre[at], turn[at], inertia[at]
        place = np.array([self.x, self.y, self.z])
        joined = _with_point(*before, self.mass, place)
        model.body_mass[at], centre[at], turn[at], inertia[at] = joined


@final
@dataclass(frozen=True)
class BodyMass(Effect):
    """A body is heavier than assumed, its centre of mass unchanged, its inertia in proportion."""

    mass: float = 0.0

    kind = "body_mass"
    sizes = (Size("mass", "kg"),)
    source = "Appendix B gives masses to three digits"
    rows = (Row(LINKS, (0.05, 0.1, 4.0), WEIGHED, part=Part.PAYLOAD),)
    anywhere = Anywhere(
        Element.BODY,
        lambda p: (LOAD if p.carries else 0.5) * p.mass,
        lambda p: 0.001 * p.mass,
        change.MASS,
        source="assumed: up to half of the body, three times the last one of an arm",
    )

    def least(self, nominal: float) -> float:
        """A hundredth of the body."""
        return LEFT * nominal

    def edit_arm(self, arm: mujoco.MjSpec) -> None:
        """Scale mass and inertia of the link."""
        body = arm.body(self.target.removeprefix("arm."))
        share = 1.0 + self.mass / float(body.mass)
        body.mass = float(body.mass) * share
        body.inertia = _possible([share * value for value in body.inertia])

    def edit_model(self, model: mujoco.MjModel) -> None:
        """Scale the inertia, if the body has any mass, and add to the mass."""
        before = self.present(model)
        if before > 0.0:
            model.body_inertia[model.body(self.target).id] *= 1.0 + self.mass / before
        super().edit_model(model)


@final
@dataclass(frozen=True)
class MassCentre(Effect):
    """The centre of mass of a body lies off along one of its axes; target "tool.x"."""

    shift: float = 0.0

    kind = "mass_centre"
    sizes = (Size("shift", "m"),)
    source = "Appendix B gives centres of mass to the millimetre"
    rows = (
        Row(
            tuple(f"{link}.{axis}" for link in LINKS for axis in "xyz"),
            (2e-3, 4e-3, 0.1),
            WEIGHED,
            part=Part.PAYLOAD,
        ),
    )
    anywhere = Anywhere(
        Element.BODY, 0.2, 2e-4, change.CENTRE, axis=True, source="assumed: up to 0.2 m"
    )

    def edit_arm(self, arm: mujoco.MjSpec) -> None:
        """Shift the centre of mass."""
        link, axis = divmod(self.index, 3)
        body = arm.body(f"link{link + 1}")
        centre = list(body.ipos)
        centre[axis] += self.shift
        body.ipos = centre


@final
@dataclass(frozen=True)
class BodyPlace(Effect):
    """A body, and the joint that carries it, sits elsewhere on its parent; target "tool.x".

    Along a link it is the length of the link before it.
    """

    shift: float = 0.0

    kind = "body_place"
    sizes = (Size("shift", "m"),)
    anywhere = Anywhere(
        Element.BODY, 0.2, 2e-4, change.PLACE, axis=True, source="assumed: up to 0.2 m"
    )


@final
@dataclass(frozen=True)
class GravityDirection(Effect):
    """The machine stands askew: gravity is turned about an axis of the world, "x" or "y"."""

    angle: float = 0.0

    kind = "gravity_direction"
    sizes = (Size("angle", "rad"),)
    # half a degree is a careless set-up, 0.2 rad a wedge
    anywhere = Anywhere(Element.WORLD, 0.2, 5e-4, source="assumed: up to 0.2 rad")

    def edit_model(self, model: mujoco.MjModel) -> None:
        """Turn the vector of gravity."""
        turn, axis = np.array([np.cos(self.angle), np.sin(self.angle)]), "xy".index(self.target)
        one, two = ((1, 2), (2, 0))[axis]  # a right-handed turn about the axis
        before = model.opt.gravity.copy()
        model.opt.gravity[one] = turn[0] * before[one] - turn[1] * before[two]
        model.opt.gravity[two] = turn[1] * before[one] + turn[0] * before[two]


@final
@dataclass(frozen=True)
class BodyInertia(Effect):
    """A body turns harder than assumed, its mass unchanged: mass farther out."""

    share: float = 0.0

    kind = "body_inertia"
    sizes = (Size("share", "1"),)
    anywhere = Anywhere(Element.BODY, 0.5, 0.002, source="assumed: up to half")

    def least(self, nominal: float) -> float:
        """All but a hundredth of the inertia gone."""
        return LEFT - 1.0

    def edit_model(self, model: mujoco.MjModel) -> None:
        """Scale the inertia about the centre of mass."""
        model.body_inertia[model.body(self.target).id] *= 1.0 + self.share


def _add_mass(arm: mujoco.MjSpec, name: str, mass: float, at: FloatArray) -> None:
    body = arm.body(name)
    before = float(body.mass), np.asarray(body.ipos), np.asarray(body.iquat)
    joined = _with_point(*before, np.asarray(body.inertia), mass, at)
    body.mass, body.ipos, body.iquat, inertia = joined
    body.inertia = _possible(list(inertia))


def _with_point(
    body: float,
    centre: FloatArray,
    turn: FloatArray,
    inertia: FloatArray,
    mass: float,
    place: FloatArray,
) -> tuple[float, FloatArray, FloatArray, FloatArray]:
    """Mass, centre, principal axes (a quaternion) and inertias of a body with a point mass."""
    import mujoco

    axes = np.zeros(9)
    mujoco.mju_quat2Mat(axes, turn)
    full = axes.reshape(3, 3) @ np.diag(inertia) @ axes.reshape(3, 3).T
    together = body + mass
    apart = place - centre
    full = full + body * mass / together * (apart @ apart * np.eye(3) - np.outer(apart, apart))
    principal, quat = np.zeros(3), np.zeros(4)
    mujoco.mju_eig3(principal, axes, quat, full.ravel())
    return together, centre + mass / together * apart, quat, principal


def _possible(inertia: list[float]) -> list[float]:
    """Principal inertias with the largest no more than the sum of the others, but for round-off.

    Link 3 is a plate to the last digit, A + B = C, which round-off alone would break.
    """
    largest = max(range(3), key=inertia.__getitem__)
    others = sum(value for i, value in enumerate(inertia) if i != largest)
    if others <= inertia[largest] < others * (1.0 + 1e-9):
        inertia[largest] = others * (1.0 - 1e-12)
    return inertia
