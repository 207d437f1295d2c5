"""Effects of a joint: friction of four kinds, constant force, spring, rotor inertia, backlash."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, final

import numpy as np

from ves_twin.effects.magnitude import Magnitude, Sign
from ves_twin.rigs.effect import LEAST, Place, RigEffect, play
from ves_twin.rigs.element import Element
from ves_twin.types import FloatArray

if TYPE_CHECKING:
    import mujoco


def _effort(place: Place) -> str:
    return place.pick("N", "N*m")


def _one(name: str, unit: str, largest: float, sign: Sign = Sign.BOTH) -> tuple[Magnitude, ...]:
    return (Magnitude(name, unit, 0.0, LEAST * largest, largest, sign),)


@final
@dataclass(frozen=True)
class ViscousFriction(RigEffect):
    """A joint moves harder in proportion to its speed: MuJoCo's damping."""

    damping: float = 0.0

    kind: ClassVar[str] = "viscous_friction"
    element: ClassVar[Element] = Element.JOINT
    attribute: ClassVar[str] = "damping"

    @classmethod
    def magnitudes(cls, place: Place) -> tuple[Magnitude, ...]:
        """Up to three times what takes the typical effort at the typical speed."""
        unit = place.pick("N*s/m", "N*m*s/rad")
        return _one("damping", unit, 3.0 * place.effort / place.speed, Sign.POSITIVE)

    def present(self, model: mujoco.MjModel) -> float:
        """Of the joint, in the model."""
        return float(model.dof_damping[model.joint(self.target).dofadr[0]])

    def edit_model(self, model: mujoco.MjModel) -> None:
        """Add to the damping of the joint."""
        model.dof_damping[model.joint(self.target).dofadr[0]] += self.damping


@final
@dataclass(frozen=True)
class CoulombFriction(RigEffect):
    """Dry friction: MuJoCo's friction loss forward, level * tanh(v / slow) where motion is given.

    Inverse dynamics of MuJoCo's friction loss weighs acceleration against speed near a reversal,
    where a real joint has the sign of its speed.
    """

    level: float = 0.0

    kind: ClassVar[str] = "coulomb_friction"
    element: ClassVar[Element] = Element.JOINT
    attribute: ClassVar[str] = "frictionloss"

    @classmethod
    def magnitudes(cls, place: Place) -> tuple[Magnitude, ...]:
        """Up to the typical effort."""
        return _one("level", _effort(place), place.effort, Sign.POSITIVE)

    def present(self, model: mujoco.MjModel) -> float:
        """Of the joint, in the model."""
        return float(model.dof_frictionloss[model.joint(self.target).dofadr[0]])

    def edit_model(self, model: mujoco.MjModel) -> None:
        """Add to the friction loss of the joint."""
        model.dof_frictionloss[model.joint(self.target).dofadr[0]] += self.level


@final
@dataclass(frozen=True)
class ViscousAsymmetry(RigEffect):
    """Viscous friction that differs by direction: c +- slope, an effort slope * |v|."""

    slope: float = 0.0

    kind: ClassVar[str] = "viscous_asymmetry"
    element: ClassVar[Element] = Element.JOINT

    @classmethod
    def magnitudes(cls, place: Place) -> tuple[Magnitude, ...]:
        """Up to what takes the typical effort at the typical speed."""
        return _one("slope", place.pick("N*s/m", "N*m*s/rad"), place.effort / place.speed)

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

    @classmethod
    def magnitudes(cls, place: Place) -> tuple[Magnitude, ...]:
        """Up to half the typical effort."""
        return _one("level", _effort(place), 0.5 * place.effort)

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

    @classmethod
    def magnitudes(cls, place: Place) -> tuple[Magnitude, ...]:
        """Up to half the typical effort."""
        return _one("offset", _effort(place), 0.5 * place.effort)

    def resist(self, speed: FloatArray, slow: float) -> FloatArray:
        """The offset."""
        return np.full_like(speed, self.offset)


@final
@dataclass(frozen=True)
class JointSpring(RigEffect):
    """A cable or hose pulls the joint towards its reference: MuJoCo's stiffness."""

    stiffness: float = 0.0

    kind: ClassVar[str] = "joint_spring"
    element: ClassVar[Element] = Element.JOINT
    attribute: ClassVar[str] = "stiffness"

    @classmethod
    def magnitudes(cls, place: Place) -> tuple[Magnitude, ...]:
        """Up to the typical effort over the typical travel."""
        unit = place.pick("N/m", "N*m/rad")
        return _one("stiffness", unit, place.effort / place.travel, Sign.POSITIVE)

    def present(self, model: mujoco.MjModel) -> float:
        """Of the joint, in the model."""
        return float(model.jnt_stiffness[model.joint(self.target).id])

    def edit_model(self, model: mujoco.MjModel) -> None:
        """Add to the stiffness of the joint."""
        model.jnt_stiffness[model.joint(self.target).id] += self.stiffness


@final
@dataclass(frozen=True)
class RotorInertia(RigEffect):
    """Rotor and gears have more inertia than assumed, seen at the joint: MuJoCo's armature."""

    inertia: float = 0.0

    kind: ClassVar[str] = "rotor_inertia"
    element: ClassVar[Element] = Element.JOINT
    attribute: ClassVar[str] = "armature"

    @classmethod
    def magnitudes(cls, place: Place) -> tuple[Magnitude, ...]:
        """Up to what takes the typical effort to reach the typical speed over half the travel."""
        largest = place.effort * place.travel / place.speed**2
        return _one("inertia", place.pick("kg", "kg*m^2"), largest, Sign.POSITIVE)

    def present(self, model: mujoco.MjModel) -> float:
        """Of the joint, in the model."""
        return float(model.dof_armature[model.joint(self.target).dofadr[0]])

    def edit_model(self, model: mujoco.MjModel) -> None:
        """Add to the armature of the joint."""
        model.dof_armature[model.joint(self.target).dofadr[0]] += self.inertia


@final
@dataclass(frozen=True)
class Backlash(RigEffect):
    """Lost motion between where a joint is measured and the joint: a gap."""

    gap: float = 0.0

    kind: ClassVar[str] = "backlash"
    element: ClassVar[Element] = Element.JOINT

    @classmethod
    def magnitudes(cls, place: Place) -> tuple[Magnitude, ...]:
        """Up to a twentieth of the typical travel."""
        largest = 0.05 * place.travel
        return _one("gap", place.pick("m", "rad"), largest, Sign.POSITIVE)

    def edit_position(self, position: FloatArray) -> FloatArray:
        """The side that is dragged along."""
        return play(position, self.gap)
