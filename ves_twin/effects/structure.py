"""Effects of VES II's structure: anchors, bending of a leg, tilt of the base, hoses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, final

from ves_twin.effects.effect import Effect
from ves_twin.effects.magnitude import Sign
from ves_twin.effects.row import LEGS, RIG, Part, Row
from ves_twin.effects.size import Size

if TYPE_CHECKING:
    import mujoco


@final
@dataclass(frozen=True)
class AnchorPosition(Effect):
    """The joint of a leg on the platform sits off its drawing position, along a platform axis."""

    offset: float = 0.0

    kind = "anchor_position"
    sizes = (Size("offset", "m"),)
    source = "assumed; machining and assembly of a welded frame"
    rows = (
        Row(
            tuple(f"{leg}.{axis}" for leg in LEGS for axis in "xyz"),
            (1e-4, 3e-4, 0.02),
            ("sensor.wrench", "valve.command"),
            part=Part.STRUCTURE,
        ),
    )

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

    kind = "base_tilt"
    sizes = (Size("roll", "rad"), Size("pitch", "rad"))
    source = "thesis 3.4.5: half a degree of orientation is not acceptable"
    rows = (Row(RIG, (3e-4, 1e-3, 0.05), ("sensor.wrench",), part=Part.STRUCTURE),)

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

    kind = "hose_stiffness"
    sizes = (Size("stiffness", "N/m", Sign.POSITIVE),)
    source = "assumed; six pairs of hydraulic hoses"
    proportional = False
    rows = (Row(RIG, (50.0, 100.0, 2e4), ("leg.length", "valve.command"), part=Part.STRUCTURE),)

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

    kind = "leg_bending"
    sizes = (Size("loss", "1", Sign.POSITIVE),)
    source = "thesis 5.2: first modes of 10 to 13 Hz; a loose or cracked leg"
    proportional = False
    rows = (Row(LEGS, (0.02, 0.05, 0.8), ("sensor.wrench",), part=Part.STRUCTURE),)

    def edit_rig(self, rig: mujoco.MjSpec) -> None:
        """Lower the stiffness of the leg's two bending hinges."""
        for axis in "xy":
            joint = rig.joint(f"leg{self.index + 1}/bending_{axis}")
            joint.stiffness = joint.stiffness * (1.0 - self.loss)
