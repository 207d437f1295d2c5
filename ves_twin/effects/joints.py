"""Effects of a joint: friction of four kinds, constant force, inertia, springs, backlash."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, final

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.effects import change
from ves_twin.effects.change import Table
from ves_twin.effects.effect import Effect
from ves_twin.effects.element import Element
from ves_twin.effects.magnitude import Magnitude, Sign
from ves_twin.effects.place import Place
from ves_twin.effects.resistance import Form, Resistance
from ves_twin.effects.row import JOINTS, LEGS, Anywhere, Part, Row
from ves_twin.effects.size import (
    COMPLIANCE,
    CUBIC,
    DAMPING,
    EFFORT,
    INERTIA,
    LENGTH,
    STIFFNESS,
    Size,
)

if TYPE_CHECKING:
    import mujoco

TORQUE = ("arm.torque",)


@final
@dataclass(frozen=True)
class CoulombFriction(Effect):
    """Dry friction: a joint or piston sticks below `level` and slides against it above.

    In a MuJoCo model its friction loss. Where motion is given it is level * tanh(v / slow):
    inverse dynamics of MuJoCo's friction loss weighs acceleration against speed near a reversal,
    where a real joint has the sign of its speed.
    """

    level: float = 0.0

    kind = "coulomb_friction"
    sizes = (Size("level", EFFORT, Sign.POSITIVE),)
    proportional = False
    rows = (
        Row(
            LEGS,
            (0.0, 5.0, 400.0),
            ("leg.length", "sensor.wrench"),
            Table("leg.dry_friction"),
            Part.CYLINDER,
            source="assumed; 1 to 3 % of the 12 kN that a leg can give",
        ),
        Row(
            JOINTS,
            (0.3, 0.5, 30.0),
            TORQUE,
            change.FRICTION_LOSS,
            Part.ARM,
            source="Armstrong-Helouvry and Corke 1994: 3.9 to 8 N m in all at these joints",
        ),
    )
    anywhere = Anywhere(Element.JOINT, lambda p: p.effort, attribute=change.FRICTION_LOSS)


@final
@dataclass(frozen=True)
class ViscousFriction(Effect):
    """A joint or piston moves harder in proportion to its speed: seals, cold oil, grease."""

    damping: float = 0.0

    kind = "viscous_friction"
    sizes = (Size("damping", DAMPING, Sign.POSITIVE),)
    rows = (
        Row(
            LEGS,
            (50.0, 100.0, 2e4),
            ("leg.length",),
            Table("chamber.viscous"),
            Part.CYLINDER,
            source="assumed; seals",
        ),
        Row(
            JOINTS,
            (0.4, 0.8, 30.0),
            TORQUE,
            change.DAMPING,
            Part.ARM,
            source="Armstrong-Helouvry and Corke 1994; varies with temperature",
        ),
    )
    # up to three times what takes the typical effort at the typical speed
    anywhere = Anywhere(Element.JOINT, lambda p: 3.0 * p.effort / p.speed, attribute=change.DAMPING)


@final
@dataclass(frozen=True)
class ViscousAsymmetry(Effect):
    """Viscous friction that differs by direction: c +- slope, an effort slope * |v|."""

    slope: float = 0.0

    kind = "viscous_asymmetry"
    sizes = (Size("slope", DAMPING),)
    anywhere = Anywhere(Element.JOINT, lambda p: p.effort / p.speed)

    @property
    def resistance(self) -> Resistance:
        """Slope times the size of the speed."""
        return Resistance(Form.BY_SIZE, (self.slope,))


@final
@dataclass(frozen=True)
class CoulombAsymmetry(Effect):
    """Dry friction that differs by direction: a constant effort while the joint moves."""

    level: float = 0.0

    kind = "coulomb_asymmetry"
    sizes = (Size("level", EFFORT),)
    anywhere = Anywhere(Element.JOINT, lambda p: 0.5 * p.effort)

    @property
    def resistance(self) -> Resistance:
        """The level, gone where the joint stands."""
        return Resistance(Form.BY_SIDE, (self.level,))


@final
@dataclass(frozen=True)
class ForceOffset(Effect):
    """A constant effort that the drive must give, or a current that reads off zero."""

    offset: float = 0.0

    kind = "force_offset"
    sizes = (Size("offset", EFFORT),)
    anywhere = Anywhere(Element.JOINT, lambda p: 0.5 * p.effort)

    @property
    def resistance(self) -> Resistance:
        """The offset."""
        return Resistance(Form.STEADY, (self.offset,))


@final
@dataclass(frozen=True)
class RotorInertia(Effect):
    """Rotor and gears have more inertia than assumed, seen at the joint: MuJoCo's armature."""

    inertia: float = 0.0

    kind = "rotor_inertia"
    sizes = (Size("inertia", INERTIA, Sign.POSITIVE),)
    source = "Armstrong, Khatib and Burdick 1986"
    rows = (Row(JOINTS, (0.02, 0.05, 5.0), TORQUE, change.ARMATURE, Part.ARM),)
    # up to what takes the typical effort to reach the typical speed over half the travel
    anywhere = Anywhere(
        Element.JOINT, lambda p: p.effort * p.travel / p.speed**2, attribute=change.ARMATURE
    )


@final
@dataclass(frozen=True)
class JointSpring(Effect):
    """A cable or hose across a joint pulls it back towards q = 0: MuJoCo's stiffness."""

    stiffness: float = 0.0

    kind = "joint_spring"
    sizes = (Size("stiffness", STIFFNESS, Sign.POSITIVE),)
    source = "assumed; dressing of the wrist and the force sensor's cable"
    rows = (Row(JOINTS, (0.3, 0.5, 40.0), TORQUE, change.STIFFNESS, Part.ARM),)
    # twice what holds the typical effort at the typical travel, to which a step swings past
    anywhere = Anywhere(
        Element.JOINT, lambda p: 2.0 * p.effort / p.travel, attribute=change.STIFFNESS
    )


@final
@dataclass(frozen=True)
class JointCompliance(Effect):
    """What carries a load gives way by more than its spring: air in oil, a belt, teeth of a gear.

    A compliance c in series with the joint's stiffness k0, in the model k0 / (1 + c k0). Deflection
    under a load is linear in c, and not in a stiffness that is far too large.
    """

    compliance: float = 0.0

    kind = "joint_compliance"
    sizes = (Size("compliance", COMPLIANCE, Sign.POSITIVE),)
    # up to a spring of a twentieth of the stiffness
    anywhere = Anywhere(Element.JOINT, lambda p: 19.0 / p.stiffness)

    @classmethod
    def magnitudes_at(cls, place: Place) -> tuple[Magnitude, ...]:
        """Compliance with its range; raises InvalidInputError where the joint has no spring."""
        if not place.stiffness:
            expected = "a joint that has a stiffness in the model"
            raise InvalidInputError(f"target of {cls.kind}", place.name, expected)
        return super().magnitudes_at(place)

    def least(self, nominal: float) -> float:
        """None: nothing carries a load by less than its spring."""
        return 0.0

    def edit_model(self, model: mujoco.MjModel) -> None:
        """The softer spring."""
        at = change.STIFFNESS.entry(model, self.target)
        model.jnt_stiffness[at] /= 1.0 + self.compliance * model.jnt_stiffness[at]


@final
@dataclass(frozen=True)
class CubicSpring(Effect):
    """A spring across a joint that grows stiffer, or softer, with its travel: an effort k3 q^3.

    MuJoCo's polynomial stiffness, counted from the joint's springref.
    """

    stiffness: float = 0.0

    kind = "cubic_spring"
    sizes = (Size("stiffness", CUBIC),)
    anywhere = Anywhere(
        Element.JOINT, lambda p: 3.0 * p.effort / p.travel**3, attribute=change.CUBIC_STIFFNESS
    )


@final
@dataclass(frozen=True)
class Backlash(Effect):
    """Lost motion between where a joint is measured and the joint: a gap.

    The driven side y[k] = min(max(y[k-1], x[k] - g/2), x[k] + g/2) follows at the ends of the gap
    and rests within: the play operator.

    Source: Krasnosel'skii and Pokrovskii 1989, Systems with Hysteresis.
    """

    gap: float = 0.0

    kind = "backlash"
    sizes = (Size("gap", LENGTH, Sign.POSITIVE),)
    anywhere = Anywhere(Element.JOINT, lambda p: 0.05 * p.travel)

    def edit_position(self, position: FloatArray) -> FloatArray:
        """The side that is dragged along."""
        if self.gap == 0.0:
            return position
        half, driven = 0.5 * abs(self.gap), np.empty_like(position)
        y = float(position[0])
        for k, x in enumerate(position.tolist()):
            y = min(max(y, x - half), x + half)
            driven[k] = y
        return driven
