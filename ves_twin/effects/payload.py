"""Effects of the payload: a mass at the tool, masses and centres of mass of the links."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, final

from ves_twin.effects.effect import LINKS, Effect
from ves_twin.effects.magnitude import Magnitude, Sign

if TYPE_CHECKING:
    import mujoco
    import numpy as np


@final
@dataclass(frozen=True)
class PayloadMass(Effect):
    """A point mass that nobody declared sits at the tool."""

    mass: float = 0.0

    kind: ClassVar[str] = "payload_mass"
    targets: ClassVar[tuple[str, ...]] = ("arm.tool",)
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (
        Magnitude("mass", "kg", 0.02, 0.05, 4.0, Sign.POSITIVE),
    )
    channels: ClassVar[tuple[str, ...]] = ("sensor.wrench", "arm.torque")
    source: ClassVar[str] = "assumed; tools and cables on the wrist"

    def edit_arm(self, arm: mujoco.MjSpec) -> None:
        """Join the point mass to link 3, with centre of mass and inertia by the parallel axes."""
        if self.neutral:
            return
        import numpy as np

        _add_mass(arm, "link3", self.mass, np.asarray(arm.site("tip").pos))


@final
@dataclass(frozen=True)
class LinkMass(Effect):
    """A link is heavier than its data sheet, with its centre of mass and shape unchanged."""

    mass: float = 0.0

    kind: ClassVar[str] = "link_mass"
    targets: ClassVar[tuple[str, ...]] = LINKS
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (Magnitude("mass", "kg", 0.05, 0.1, 4.0),)
    channels: ClassVar[tuple[str, ...]] = ("sensor.wrench", "arm.torque")
    source: ClassVar[str] = "Appendix B gives masses to three digits"

    def edit_arm(self, arm: mujoco.MjSpec) -> None:
        """Scale mass and inertia of the link."""
        body = arm.body(self.target.removeprefix("arm."))
        share = 1.0 + self.mass / float(body.mass)
        body.mass = float(body.mass) * share
        body.inertia = [share * value for value in body.inertia]


@final
@dataclass(frozen=True)
class LinkCentre(Effect):
    """The centre of mass of a link lies off its data sheet, along the axes of its body."""

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0

    kind: ClassVar[str] = "link_centre"
    targets: ClassVar[tuple[str, ...]] = LINKS
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (
        Magnitude("x", "m", 2e-3, 4e-3, 0.1),
        Magnitude("y", "m", 2e-3, 4e-3, 0.1),
        Magnitude("z", "m", 2e-3, 4e-3, 0.1),
    )
    channels: ClassVar[tuple[str, ...]] = ("sensor.wrench", "arm.torque")
    source: ClassVar[str] = "Appendix B gives centres of mass to the millimetre"

    def edit_arm(self, arm: mujoco.MjSpec) -> None:
        """Shift the centre of mass."""
        body = arm.body(self.target.removeprefix("arm."))
        body.ipos = [p + d for p, d in zip(body.ipos, (self.x, self.y, self.z), strict=True)]


def _add_mass(arm: mujoco.MjSpec, name: str, mass: float, at: np.ndarray) -> None:
    import mujoco
    import numpy as np

    body = arm.body(name)
    before = float(body.mass)
    centre = (before * np.asarray(body.ipos) + mass * at) / (before + mass)
    full = np.diag(np.asarray(body.inertia))
    for m, place in ((before, np.asarray(body.ipos)), (mass, at)):
        r = place - centre
        full = full + m * (r @ r * np.eye(3) - np.outer(r, r))
    principal, axes, quat = np.zeros(3), np.zeros(9), np.zeros(4)
    mujoco.mju_eig3(principal, axes, quat, full.ravel())
    body.mass = before + mass
    # link 3 is a plate to the last digit (A + B = C), so that round-off alone would break it
    principal[0] = min(principal[0], principal[1] + principal[2])
    body.ipos, body.iquat, body.inertia = centre, quat, principal
