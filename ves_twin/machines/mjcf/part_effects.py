"""Effects of an actuator (gain, delay) and of a body (mass, centre of mass, inertia)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, final

from ves_twin.core.types import FloatArray
from ves_twin.effects.magnitude import Sign
from ves_twin.machines.mjcf.effect import RigEffect, shifted
from ves_twin.machines.mjcf.element import Element
from ves_twin.machines.mjcf.model_number import ModelNumber
from ves_twin.machines.mjcf.size import Size

if TYPE_CHECKING:
    import mujoco

LEFT = 0.01
"""Share of a body's mass and inertia that is left at least: MuJoCo takes neither at zero or below,
and a body next to nothing needs steps next to nothing."""

DELAY = Size("delay", "s", 0.05, 1e-4, Sign.POSITIVE)
"""Up to 50 ms: assumed, a slow fieldbus and its filters."""


@final
@dataclass(frozen=True)
class ActuatorGain(ModelNumber):
    """An actuator gives another effort for its command, or its current: a motor's gain."""

    gain: float = 0.0

    kind: ClassVar[str] = "actuator_gain"
    element: ClassVar[Element] = Element.ACTUATOR
    attribute: ClassVar[str] = "gain"
    array: ClassVar[str] = "actuator_gainprm"
    size: ClassVar[Size] = Size("gain", "1", 0.5, 0.002)
    source: ClassVar[str] = "assumed; magnets and amplifiers, per cents"

    def entry(self, model: mujoco.MjModel) -> tuple[int, int]:
        """The first number of its gain."""
        return int(model.actuator(self.target).id), 0


@final
@dataclass(frozen=True)
class ActuatorDelay(RigEffect):
    """A command acts later than it is recorded."""

    delay: float = 0.0

    kind: ClassVar[str] = "actuator_delay"
    element: ClassVar[Element] = Element.ACTUATOR
    size: ClassVar[Size] = DELAY

    def edit_command(self, command: FloatArray, time: FloatArray) -> FloatArray:
        """That of a delay ago."""
        return shifted(command, time, self.delay)

    def edit_row(self, command: FloatArray, time: FloatArray, row: int) -> float:
        """That of a delay ago, between the two rows about it."""
        late = row - self.delay * (len(time) - 1) / float(time[-1] - time[0])
        below = math.floor(late)
        share = late - below
        ends = command[max(below, 0)], command[min(max(below + 1, 0), row)]
        return float((1.0 - share) * ends[0] + share * ends[1])

    def edit_required(self, effort: FloatArray, time: FloatArray) -> FloatArray:
        """That of a delay ahead."""
        return shifted(effort, time, -self.delay)


@final
@dataclass(frozen=True)
class BodyMass(ModelNumber):
    """A body is heavier than assumed, its inertia in proportion: a payload, a tool."""

    mass: float = 0.0

    kind: ClassVar[str] = "body_mass"
    element: ClassVar[Element] = Element.BODY
    attribute: ClassVar[str] = "mass"
    array: ClassVar[str] = "body_mass"
    size: ClassVar[Size] = Size("mass", "kg", lambda p: 0.5 * p.mass, lambda p: 0.001 * p.mass)
    source: ClassVar[str] = "assumed: up to half of the body"

    def least(self, nominal: float) -> float:
        """A hundredth of the body."""
        return LEFT * nominal

    def edit_model(self, model: mujoco.MjModel) -> None:
        """Scale the inertia, if the body has any mass, and add to the mass."""
        before = self.present(model)
        if before > 0.0:
            model.body_inertia[self.entry(model)] *= 1.0 + self.mass / before
        super().edit_model(model)


@final
@dataclass(frozen=True)
class MassCentre(ModelNumber):
    """The centre of mass of a body lies off along one of its axes; target "tool.x"."""

    shift: float = 0.0

    kind: ClassVar[str] = "mass_centre"
    element: ClassVar[Element] = Element.BODY
    attribute: ClassVar[str] = "centre"
    array: ClassVar[str] = "body_ipos"
    size: ClassVar[Size] = Size("shift", "m", 0.2, 2e-4)
    source: ClassVar[str] = "assumed: up to 0.2 m"

    def entry(self, model: mujoco.MjModel) -> tuple[int, int]:
        """The axis of the inertial frame's place."""
        body, _, axis = self.target.rpartition(".")
        return int(model.body(body).id), "xyz".index(axis)


@final
@dataclass(frozen=True)
class BodyInertia(RigEffect):
    """A body turns harder than assumed, its mass unchanged: mass farther out."""

    share: float = 0.0

    kind: ClassVar[str] = "body_inertia"
    element: ClassVar[Element] = Element.BODY
    size: ClassVar[Size] = Size("share", "1", 0.5, 0.002)
    source: ClassVar[str] = "assumed: up to half"

    def least(self, nominal: float) -> float:
        """All but a hundredth of the inertia gone."""
        return LEFT - 1.0

    def edit_model(self, model: mujoco.MjModel) -> None:
        """Scale the inertia about the centre of mass."""
        model.body_inertia[model.body(self.target).id] *= 1.0 + self.share
