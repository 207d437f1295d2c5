"""Effects of a joint: friction of four kinds, constant force, spring, rotor inertia, backlash."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, final

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.effects.magnitude import Sign
from ves_twin.machines.mjcf.effect import RigEffect, play
from ves_twin.machines.mjcf.element import Element
from ves_twin.machines.mjcf.model_number import ModelNumber
from ves_twin.machines.mjcf.size import Size

EFFORT = ("N", "N*m")
DAMPING = ("N*s/m", "N*m*s/rad")
"""Units on a slide and on a hinge."""


@final
@dataclass(frozen=True)
class ViscousFriction(ModelNumber):
    """A joint moves harder in proportion to its speed: MuJoCo's damping."""

    damping: float = 0.0

    kind: ClassVar[str] = "viscous_friction"
    element: ClassVar[Element] = Element.JOINT
    attribute: ClassVar[str] = "damping"
    array: ClassVar[str] = "dof_damping"
    # up to three times what takes the typical effort at the typical speed
    size: ClassVar[Size] = Size(
        "damping", DAMPING, lambda p: 3.0 * p.effort / p.speed, sign=Sign.POSITIVE
    )


@final
@dataclass(frozen=True)
class CoulombFriction(ModelNumber):
    """Dry friction: MuJoCo's friction loss forward, level * tanh(v / slow) where motion is given.

    Inverse dynamics of MuJoCo's friction loss weighs acceleration against speed near a reversal,
    where a real joint has the sign of its speed.
    """

    level: float = 0.0

    kind: ClassVar[str] = "coulomb_friction"
    element: ClassVar[Element] = Element.JOINT
    attribute: ClassVar[str] = "frictionloss"
    array: ClassVar[str] = "dof_frictionloss"
    size: ClassVar[Size] = Size("level", EFFORT, lambda p: p.effort, sign=Sign.POSITIVE)


@final
@dataclass(frozen=True)
class ViscousAsymmetry(RigEffect):
    """Viscous friction that differs by direction: c +- slope, an effort slope * |v|."""

    slope: float = 0.0

    kind: ClassVar[str] = "viscous_asymmetry"
    element: ClassVar[Element] = Element.JOINT
    size: ClassVar[Size] = Size("slope", DAMPING, lambda p: p.effort / p.speed)

    def resist(self, speed: FloatArray, slow: float) -> FloatArray:
        """Slope times the size of the speed."""
        return np.asarray(self.slope * np.abs(speed))


@final
@dataclass(frozen=True)
class CoulombAsymmetry(RigEffect):
    """Dry friction that differs by direction: a constant effort while the joint moves."""

    level: float = 0.0

    kind: ClassVar[str] = "coulomb_asymmetry"
    element: ClassVar[Element] = Element.JOINT
    size: ClassVar[Size] = Size("level", EFFORT, lambda p: 0.5 * p.effort)

    def resist(self, speed: FloatArray, slow: float) -> FloatArray:
        """The level, gone where the joint stands."""
        return np.asarray(self.level * np.tanh(speed / slow) ** 2)


@final
@dataclass(frozen=True)
class ForceOffset(RigEffect):
    """A constant effort that the drive must give, or a current that reads off zero."""

    offset: float = 0.0

    kind: ClassVar[str] = "force_offset"
    element: ClassVar[Element] = Element.JOINT
    size: ClassVar[Size] = Size("offset", EFFORT, lambda p: 0.5 * p.effort)

    def resist(self, speed: FloatArray, slow: float) -> FloatArray:
        """The offset."""
        return np.full_like(speed, self.offset)


@final
@dataclass(frozen=True)
class JointSpring(ModelNumber):
    """A cable or hose pulls the joint towards its reference: MuJoCo's stiffness."""

    stiffness: float = 0.0

    kind: ClassVar[str] = "joint_spring"
    element: ClassVar[Element] = Element.JOINT
    attribute: ClassVar[str] = "stiffness"
    array: ClassVar[str] = "jnt_stiffness"
    size: ClassVar[Size] = Size(
        "stiffness", ("N/m", "N*m/rad"), lambda p: p.effort / p.travel, sign=Sign.POSITIVE
    )


@final
@dataclass(frozen=True)
class RotorInertia(ModelNumber):
    """Rotor and gears have more inertia than assumed, seen at the joint: MuJoCo's armature."""

    inertia: float = 0.0

    kind: ClassVar[str] = "rotor_inertia"
    element: ClassVar[Element] = Element.JOINT
    attribute: ClassVar[str] = "armature"
    array: ClassVar[str] = "dof_armature"
    # up to what takes the typical effort to reach the typical speed over half the travel
    size: ClassVar[Size] = Size(
        "inertia",
        ("kg", "kg*m^2"),
        lambda p: p.effort * p.travel / p.speed**2,
        sign=Sign.POSITIVE,
    )


@final
@dataclass(frozen=True)
class Backlash(RigEffect):
    """Lost motion between where a joint is measured and the joint: a gap."""

    gap: float = 0.0

    kind: ClassVar[str] = "backlash"
    element: ClassVar[Element] = Element.JOINT
    size: ClassVar[Size] = Size("gap", ("m", "rad"), lambda p: 0.05 * p.travel, sign=Sign.POSITIVE)

    def edit_position(self, position: FloatArray) -> FloatArray:
        """The side that is dragged along."""
        return play(position, self.gap)
