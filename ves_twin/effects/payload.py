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
        body.inertia = _possible([share * value for value in body.inertia])


_CENTRES = tuple(f"{link}.{axis}" for link in LINKS for axis in "xyz")


@final
@dataclass(frozen=True)
class LinkCentre(Effect):
    """The centre of mass of a link lies off its data sheet, along an axis of its body."""

    shift: float = 0.0

    kind: ClassVar[str] = "link_centre"
    targets: ClassVar[tuple[str, ...]] = _CENTRES
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (Magnitude("shift", "m", 2e-3, 4e-3, 0.1),)
    channels: ClassVar[tuple[str, ...]] = ("sensor.wrench", "arm.torque")
    source: ClassVar[str] = "Appendix B gives centres of mass to the millimetre"

    def edit_arm(self, arm: mujoco.MjSpec) -> None:
        """Shift the centre of mass."""
        link, axis = divmod(self.index, 3)
        body = arm.body(f"link{link + 1}")
        centre = list(body.ipos)
        centre[axis] += self.shift
        body.ipos = centre


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
    body.ipos, body.iquat, body.inertia = centre, quat, _possible(list(principal))


def _possible(inertia: list[float]) -> list[float]:
    """Principal inertias with the largest no more than the sum of the others, but for round-off.

    Link 3 is a plate to the last digit, A + B = C, which round-off alone would break.
    """
    largest = max(range(3), key=inertia.__getitem__)
    others = sum(value for i, value in enumerate(inertia) if i != largest)
    if others <= inertia[largest] < others * (1.0 + 1e-9):
        inertia[largest] = others * (1.0 - 1e-12)
    return inertia
