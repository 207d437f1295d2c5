"""Effects of an actuator (gain, delay) and of a body (mass, centre of mass)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, final

from ves_twin.effects.magnitude import Magnitude, Sign
from ves_twin.rigs.effect import Place, RigEffect, shifted
from ves_twin.rigs.element import Element
from ves_twin.types import FloatArray

if TYPE_CHECKING:
    import mujoco

SLOWEST = 0.05
"""Largest delay that is looked for [s]: assumed, a slow fieldbus and its filters."""


@final
@dataclass(frozen=True)
class ActuatorGain(RigEffect):
    """An actuator gives another effort for its command, or its current: a motor's gain."""

    gain: float = 0.0

    kind: ClassVar[str] = "actuator_gain"
    element: ClassVar[Element] = Element.ACTUATOR
    attribute: ClassVar[str] = "gain"
    source: ClassVar[str] = "assumed; magnets and amplifiers, per cents"

    @classmethod
    def magnitudes(cls, place: Place) -> tuple[Magnitude, ...]:
        """Up to a half of one."""
        return (Magnitude("gain", "1", 0.0, 0.002, 0.5),)

    def present(self, model: mujoco.MjModel) -> float:
        """Of the actuator, in the model."""
        return float(model.actuator_gainprm[model.actuator(self.target).id, 0])

    def edit_model(self, model: mujoco.MjModel) -> None:
        """Add to the gain of the actuator."""
        model.actuator_gainprm[model.actuator(self.target).id, 0] += self.gain


@final
@dataclass(frozen=True)
class ActuatorDelay(RigEffect):
    """A command acts later than it is recorded."""

    delay: float = 0.0

    kind: ClassVar[str] = "actuator_delay"
    element: ClassVar[Element] = Element.ACTUATOR

    @classmethod
    def magnitudes(cls, place: Place) -> tuple[Magnitude, ...]:
        """Up to 50 ms."""
        return (Magnitude("delay", "s", 0.0, 1e-4, SLOWEST, Sign.POSITIVE),)

    def edit_command(self, command: FloatArray, time: FloatArray) -> FloatArray:
        """That of a delay ago."""
        return shifted(command, time, self.delay)

    def edit_required(self, effort: FloatArray, time: FloatArray) -> FloatArray:
        """That of a delay ahead."""
        return shifted(effort, time, -self.delay)


@final
@dataclass(frozen=True)
class BodyMass(RigEffect):
    """A body is heavier than assumed, its inertia in proportion: a payload, a tool."""

    mass: float = 0.0

    kind: ClassVar[str] = "body_mass"
    element: ClassVar[Element] = Element.BODY
    attribute: ClassVar[str] = "mass"
    source: ClassVar[str] = "assumed: up to half of the body"

    @classmethod
    def magnitudes(cls, place: Place) -> tuple[Magnitude, ...]:
        """Up to half of its mass."""
        return (Magnitude("mass", "kg", 0.0, 0.001 * place.mass, 0.5 * place.mass),)

    def present(self, model: mujoco.MjModel) -> float:
        """Of the body, in the model."""
        return float(model.body_mass[model.body(self.target).id])

    def edit_model(self, model: mujoco.MjModel) -> None:
        """Scale mass and inertia."""
        body = model.body(self.target).id
        factor = 1.0 + self.mass / float(model.body_mass[body])
        model.body_mass[body] += self.mass
        model.body_inertia[body] *= factor


@final
@dataclass(frozen=True)
class MassCentre(RigEffect):
    """The centre of mass of a body lies off along one of its axes; target "tool.x"."""

    shift: float = 0.0

    kind: ClassVar[str] = "mass_centre"
    element: ClassVar[Element] = Element.BODY
    attribute: ClassVar[str] = "centre"
    source: ClassVar[str] = "assumed: up to 0.2 m"

    @classmethod
    def magnitudes(cls, place: Place) -> tuple[Magnitude, ...]:
        """Up to 0.2 m."""
        return (Magnitude("shift", "m", 0.0, 2e-4, 0.2),)

    def present(self, model: mujoco.MjModel) -> float:
        """Of the body, in the model."""
        return float(model.body_ipos[self._where(model)])

    def edit_model(self, model: mujoco.MjModel) -> None:
        """Move the inertial frame."""
        model.body_ipos[self._where(model)] += self.shift

    def _where(self, model: mujoco.MjModel) -> tuple[int, int]:
        body, _, axis = self.target.rpartition(".")
        return model.body(body).id, "xyz".index(axis)


@final
@dataclass(frozen=True)
class BodyInertia(RigEffect):
    """A body turns harder than assumed, its mass unchanged: mass farther out."""

    share: float = 0.0

    kind: ClassVar[str] = "body_inertia"
    element: ClassVar[Element] = Element.BODY
    source: ClassVar[str] = "assumed: up to half"

    @classmethod
    def magnitudes(cls, place: Place) -> tuple[Magnitude, ...]:
        """Up to half."""
        return (Magnitude("share", "1", 0.0, 0.002, 0.5),)

    def edit_model(self, model: mujoco.MjModel) -> None:
        """Scale the inertia about the centre of mass."""
        model.body_inertia[model.body(self.target).id] *= 1.0 + self.share
