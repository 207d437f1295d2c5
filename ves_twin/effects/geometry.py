"""Effects of structure and surroundings: anchors, bending of a leg, tilt of the base, hoses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, final

from ves_twin.effects.effect import LEGS, RIG, Effect
from ves_twin.effects.magnitude import Magnitude, Sign

if TYPE_CHECKING:
    import mujoco


_ANCHORS = tuple(f"{leg}.{axis}" for leg in LEGS for axis in "xyz")


@final
@dataclass(frozen=True)
class AnchorPosition(Effect):
    """The joint of a leg on the platform sits off its drawing position, along a platform axis."""

    offset: float = 0.0

    kind: ClassVar[str] = "anchor_position"
    targets: ClassVar[tuple[str, ...]] = _ANCHORS
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (Magnitude("offset", "m", 1e-4, 3e-4, 0.02),)
    channels: ClassVar[tuple[str, ...]] = ("sensor.wrench", "valve.command")
    source: ClassVar[str] = "assumed; machining and assembly of a welded frame"

    def edit_rig(self, rig: mujoco.MjSpec) -> None:
        """Move the site that the leg closes on."""
        leg, axis = divmod(self.index, 3)
        site = rig.site(f"platform/joint{leg + 1}")
        position = list(site.pos)
        position[axis] += self.offset
        site.pos = position


@final
@dataclass(frozen=True)
class BaseTilt(Effect):
    """The floor frame is not level: gravity leans by small angles about X and Y of the base."""

    roll: float = 0.0
    pitch: float = 0.0

    kind: ClassVar[str] = "base_tilt"
    targets: ClassVar[tuple[str, ...]] = RIG
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (
        Magnitude("roll", "rad", 3e-4, 1e-3, 0.05),
        Magnitude("pitch", "rad", 3e-4, 1e-3, 0.05),
    )
    channels: ClassVar[tuple[str, ...]] = ("sensor.wrench",)
    source: ClassVar[str] = "thesis 3.4.5: half a degree of orientation is not acceptable"

    def edit_rig(self, rig: mujoco.MjSpec) -> None:
        """Turn gravity into the axes of a base that is rolled, then pitched: g_b = R^T g."""
        if self.neutral:
            return
        from math import cos, sin

        g = -float(rig.option.gravity[2])
        rig.option.gravity = [
            g * sin(self.pitch),
            -g * sin(self.roll) * cos(self.pitch),
            -g * cos(self.roll) * cos(self.pitch),
        ]


@final
@dataclass(frozen=True)
class HoseStiffness(Effect):
    """Hoses pull the platform back towards home: a spring on its position and its orientation.

    MuJoCo's spring of a free joint has one number for both, in N/m and N m/rad.
    """

    stiffness: float = 0.0

    kind: ClassVar[str] = "hose_stiffness"
    targets: ClassVar[tuple[str, ...]] = RIG
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (
        Magnitude("stiffness", "N/m", 50.0, 100.0, 2e4, Sign.POSITIVE),
    )
    channels: ClassVar[tuple[str, ...]] = ("leg.length", "valve.command")
    source: ClassVar[str] = "assumed; six pairs of hydraulic hoses"

    def edit_rig(self, rig: mujoco.MjSpec) -> None:
        """Give the platform's free joint a spring."""
        if self.neutral:
            return
        import numpy as np

        rig.joint("platform/free").stiffness = np.array([self.stiffness, 0.0, 0.0])


@final
@dataclass(frozen=True)
class LegBending(Effect):
    """A leg bends more easily: stiffness k -> (1 - loss) k, so that its mode falls by the root.

    Transducers do not see it; straight legs (`fast`) have no room for it.
    """

    loss: float = 0.0

    kind: ClassVar[str] = "leg_bending"
    targets: ClassVar[tuple[str, ...]] = LEGS
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (
        Magnitude("loss", "1", 0.02, 0.05, 0.8, Sign.POSITIVE),
    )
    channels: ClassVar[tuple[str, ...]] = ("sensor.wrench",)
    source: ClassVar[str] = "thesis 5.2: first modes of 10 to 13 Hz; a loose or cracked leg"

    def edit_rig(self, rig: mujoco.MjSpec) -> None:
        """Lower the stiffness of the leg's two bending hinges."""
        for axis in "xy":
            joint = rig.joint(f"leg{self.index + 1}/bending_{axis}")
            joint.stiffness = joint.stiffness * (1.0 - self.loss)
