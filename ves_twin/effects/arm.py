"""Effects of the arm's joints: friction, rotor inertia, drive, encoder, cables."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, final

from ves_twin.effects.effect import JOINTS, Effect
from ves_twin.effects.magnitude import Magnitude, Sign

if TYPE_CHECKING:
    import mujoco
    import numpy as np


@final
@dataclass(frozen=True)
class JointFriction(Effect):
    """Dry friction in a joint: MuJoCo's friction loss, which sticks and slides."""

    level: float = 0.0

    kind: ClassVar[str] = "joint_friction"
    targets: ClassVar[tuple[str, ...]] = JOINTS
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (
        Magnitude("level", "N*m", 0.3, 0.5, 30.0, Sign.POSITIVE),
    )
    channels: ClassVar[tuple[str, ...]] = ("arm.torque",)
    source: ClassVar[str] = "Armstrong-Helouvry and Corke 1994: 3.9 to 8 N m in all at these joints"

    def edit_arm(self, arm: mujoco.MjSpec) -> None:
        """Add to the friction loss of the joint."""
        joint = arm.joint(self.target.removeprefix("arm."))
        joint.frictionloss = float(joint.frictionloss) + self.level


@final
@dataclass(frozen=True)
class JointViscous(Effect):
    """A joint turns harder in proportion to its speed: oil and grease, temperature."""

    damping: float = 0.0

    kind: ClassVar[str] = "joint_viscous"
    targets: ClassVar[tuple[str, ...]] = JOINTS
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (
        Magnitude("damping", "N*m*s/rad", 0.4, 0.8, 30.0, Sign.POSITIVE),
    )
    channels: ClassVar[tuple[str, ...]] = ("arm.torque",)
    source: ClassVar[str] = "Armstrong-Helouvry and Corke 1994; varies with temperature"

    def edit_arm(self, arm: mujoco.MjSpec) -> None:
        """Add to the damping of the joint."""
        import numpy as np

        joint = arm.joint(self.target.removeprefix("arm."))
        joint.damping = np.asarray(joint.damping) + np.array([self.damping, 0.0, 0.0])


@final
@dataclass(frozen=True)
class RotorInertia(Effect):
    """The rotor and gears of a joint have more inertia than assumed, seen at the joint."""

    inertia: float = 0.0

    kind: ClassVar[str] = "rotor_inertia"
    targets: ClassVar[tuple[str, ...]] = JOINTS
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (
        Magnitude("inertia", "kg*m^2", 0.02, 0.05, 5.0, Sign.POSITIVE),
    )
    channels: ClassVar[tuple[str, ...]] = ("arm.torque",)
    source: ClassVar[str] = "Armstrong, Khatib and Burdick 1986"

    def edit_arm(self, arm: mujoco.MjSpec) -> None:
        """Add to the armature of the joint."""
        joint = arm.joint(self.target.removeprefix("arm."))
        joint.armature = float(joint.armature) + self.inertia


@final
@dataclass(frozen=True)
class CableSpring(Effect):
    """A cable across a joint pulls it back towards q = 0."""

    stiffness: float = 0.0

    kind: ClassVar[str] = "cable_spring"
    targets: ClassVar[tuple[str, ...]] = JOINTS
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (
        Magnitude("stiffness", "N*m/rad", 0.3, 0.5, 40.0, Sign.POSITIVE),
    )
    channels: ClassVar[tuple[str, ...]] = ("arm.torque",)
    source: ClassVar[str] = "assumed; dressing of the wrist and the force sensor's cable"

    def edit_arm(self, arm: mujoco.MjSpec) -> None:
        """Add a spring to the joint."""
        import numpy as np

        joint = arm.joint(self.target.removeprefix("arm."))
        joint.stiffness = np.asarray(joint.stiffness) + np.array([self.stiffness, 0.0, 0.0])


@final
@dataclass(frozen=True)
class TorqueConstant(Effect):
    """A drive gives more torque than its current says: applied (1 + gain) T, recorded T."""

    gain: float = 0.0

    kind: ClassVar[str] = "torque_constant"
    targets: ClassVar[tuple[str, ...]] = JOINTS
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (Magnitude("gain", "1", 0.01, 0.02, 0.3),)
    channels: ClassVar[tuple[str, ...]] = ("arm.torque",)
    source: ClassVar[str] = "assumed; magnets and amplifiers, a per cent"

    def edit_loop(self, parameters: np.void) -> None:
        """Scale the torque that reaches the joint."""
        parameters["drive"]["torque_gain"][self.index] *= 1.0 + self.gain


@final
@dataclass(frozen=True)
class EncoderOffset(Effect):
    """An encoder was zeroed off the joint's zero: it reads, and the servo holds, q + offset."""

    offset: float = 0.0

    kind: ClassVar[str] = "encoder_offset"
    targets: ClassVar[tuple[str, ...]] = JOINTS
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (Magnitude("offset", "rad", 5e-4, 1e-3, 0.05),)
    channels: ClassVar[tuple[str, ...]] = ("sensor.wrench", "arm.torque")
    source: ClassVar[str] = "Appendix E: the arm is at its home when the controller starts"

    def edit_loop(self, parameters: np.void) -> None:
        """Shift what the encoder reads."""
        parameters["drive"]["encoder_offset"][self.index] += self.offset
