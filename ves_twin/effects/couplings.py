"""Effects of a fixed tendon, which couples joints: inertia, viscous and dry friction, a spring."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

from ves_twin.core.errors import InvalidInputError
from ves_twin.effects.change import Attribute
from ves_twin.effects.effect import Effect
from ves_twin.effects.element import Element
from ves_twin.effects.magnitude import Magnitude, Sign
from ves_twin.effects.place import Place
from ves_twin.effects.row import Anywhere
from ves_twin.effects.size import DAMPING, EFFORT, INERTIA, STIFFNESS, Size

ON = Element.TENDON


@final
@dataclass(frozen=True)
class CouplingInertia(Effect):
    """A part that turns with a sum of joint speeds has inertia: MuJoCo's armature of a tendon."""

    inertia: float = 0.0

    kind = "coupling_inertia"
    sizes = (Size("inertia", INERTIA, Sign.POSITIVE),)
    anywhere = Anywhere(
        ON,
        lambda p: p.effort * p.travel / p.speed**2,
        attribute=Attribute(ON, "armature", "tendon_armature"),
    )


@final
@dataclass(frozen=True)
class CouplingViscous(Effect):
    """Viscous friction on a sum of joint speeds: MuJoCo's damping of a tendon."""

    damping: float = 0.0

    kind = "coupling_viscous"
    sizes = (Size("damping", DAMPING, Sign.POSITIVE),)
    anywhere = Anywhere(
        ON,
        lambda p: 3.0 * p.effort / p.speed,
        attribute=Attribute(ON, "damping", "tendon_damping"),
    )


@final
@dataclass(frozen=True)
class CouplingCoulomb(Effect):
    """Dry friction on a sum of joint speeds: MuJoCo's friction loss of a tendon.

    Where motion is given it is level * tanh(v / slow) with v the tendon's speed.
    """

    level: float = 0.0

    kind = "coupling_coulomb"
    sizes = (Size("level", EFFORT, Sign.POSITIVE),)
    anywhere = Anywhere(
        ON, lambda p: p.effort, attribute=Attribute(ON, "frictionloss", "tendon_frictionloss")
    )


@final
@dataclass(frozen=True)
class CouplingSpring(Effect):
    """The spring between two joints is stiffer or softer: MuJoCo's stiffness of a tendon.

    That of a series elastic drive, up to nothing and to twice as stiff.
    """

    stiffness: float = 0.0

    kind = "coupling_spring"
    sizes = (Size("stiffness", STIFFNESS, Sign.POSITIVE),)
    anywhere = Anywhere(
        ON, lambda p: p.stiffness, attribute=Attribute(ON, "stiffness", "tendon_stiffness")
    )

    @classmethod
    def magnitudes_at(cls, place: Place) -> tuple[Magnitude, ...]:
        """Stiffness with its range; raises InvalidInputError where the tendon has no spring."""
        if not place.stiffness:
            expected = "a tendon that has a stiffness in the model"
            raise InvalidInputError(f"target of {cls.kind}", place.name, expected)
        return super().magnitudes_at(place)
