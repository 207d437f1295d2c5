"""Size: one number of a kind of effect: its name, unit and sign, the same on every machine."""

from __future__ import annotations

from dataclasses import dataclass

from ves_twin.effects.magnitude import Sign

EFFORT = ("N", "N*m")
DAMPING = ("N*s/m", "N*m*s/rad")
STIFFNESS = ("N/m", "N*m/rad")
COMPLIANCE = ("m/N", "rad/(N*m)")
CUBIC = ("N/m^3", "N*m/rad^3")
INERTIA = ("kg", "kg*m^2")
LENGTH = ("m", "rad")
SPEED = ("m/s", "rad/s")
"""Units on a slide and on a hinge."""


@dataclass(frozen=True)
class Size:
    """A field of an effect; zero is always "no effect".

    Attributes:
        name: of the field.
        unit: SI; of a slide and of a hinge, where they differ; "" is the unit of the signal.
        sign: directions that are physical.
        component: whether it is one of a vector, so that at zero the others may say all.
    """

    name: str
    unit: str | tuple[str, str]
    sign: Sign = Sign.BOTH
    component: bool = False

    def unit_on(self, *, hinge: bool, signal: str = "1") -> str:
        """The unit at a place."""
        return (self.unit if isinstance(self.unit, str) else self.unit[hinge]) or signal
