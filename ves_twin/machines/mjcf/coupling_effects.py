"""Effects of a fixed tendon: what couples two joints by a gear: inertia, viscous, dry friction."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, final

from ves_twin.effects.magnitude import Sign
from ves_twin.machines.mjcf.element import Element
from ves_twin.machines.mjcf.joint_effects import DAMPING, EFFORT
from ves_twin.machines.mjcf.model_number import ModelNumber
from ves_twin.machines.mjcf.size import Size


@final
@dataclass(frozen=True)
class CouplingInertia(ModelNumber):
    """A part that turns with a sum of joint speeds has inertia: MuJoCo's armature of a tendon."""

    inertia: float = 0.0

    kind: ClassVar[str] = "coupling_inertia"
    element: ClassVar[Element] = Element.TENDON
    attribute: ClassVar[str] = "armature"
    array: ClassVar[str] = "tendon_armature"
    size: ClassVar[Size] = Size(
        "inertia",
        ("kg", "kg*m^2"),
        lambda p: p.effort * p.travel / p.speed**2,
        sign=Sign.POSITIVE,
    )


@final
@dataclass(frozen=True)
class CouplingViscous(ModelNumber):
    """Viscous friction on a sum of joint speeds: MuJoCo's damping of a tendon."""

    damping: float = 0.0

    kind: ClassVar[str] = "coupling_viscous"
    element: ClassVar[Element] = Element.TENDON
    attribute: ClassVar[str] = "damping"
    array: ClassVar[str] = "tendon_damping"
    size: ClassVar[Size] = Size(
        "damping", DAMPING, lambda p: 3.0 * p.effort / p.speed, sign=Sign.POSITIVE
    )


@final
@dataclass(frozen=True)
class CouplingCoulomb(ModelNumber):
    """Dry friction on a sum of joint speeds: MuJoCo's friction loss of a tendon.

    Where motion is given it is level * tanh(v / slow) with v the tendon's speed.
    """

    level: float = 0.0

    kind: ClassVar[str] = "coupling_coulomb"
    element: ClassVar[Element] = Element.TENDON
    attribute: ClassVar[str] = "frictionloss"
    array: ClassVar[str] = "tendon_frictionloss"
    size: ClassVar[Size] = Size("level", EFFORT, lambda p: p.effort, sign=Sign.POSITIVE)
