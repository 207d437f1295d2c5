"""Table, Loop, Attribute and Log: what an effect changes, and by which law."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Any

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.effects.element import Element

if TYPE_CHECKING:
    import mujoco


class Law(StrEnum):
    """What a number x becomes under an effect of size s."""

    ADD = "x + s"
    SCALE = "x (1 + s)"
    DIVIDE = "x / (1 + s)"
    LOSE = "x (1 - s)"

    def of(self, x: Any, s: float) -> Any:
        """The number, or each one of an array."""
        if self is Law.ADD:
            return x + s
        if self is Law.DIVIDE:
            return x / (1.0 + s)
        return x * (1.0 + s if self is Law.SCALE else 1.0 - s)


@dataclass(frozen=True)
class Table:
    """A value of a plant's parameter table, by its dotted name."""

    name: str
    law: Law = Law.ADD

    def edit(self, numbers: dict[str, FloatArray], index: int | None, size: float) -> None:
        """Change one entry, or all of them (None)."""
        if index is None:
            numbers[self.name] = np.asarray(self.law.of(numbers[self.name], size))
        else:
            numbers[self.name][index] = self.law.of(numbers[self.name][index], size)


@dataclass(frozen=True)
class Loop:
    """A number of the compiled loop: names of its block, "late.slide.delay"."""

    name: str
    law: Law = Law.ADD

    def edit(self, parameters: np.void, index: int | None, size: float) -> None:
        """Change one entry, or all of them (None)."""
        *blocks, field = self.name.split(".")
        block: Any = parameters
        for name in blocks:
            block = block[name]
        if index is None:
            block[field] = self.law.of(block[field], size)
        else:
            block[field][index] = self.law.of(block[field][index], size)


@dataclass(frozen=True)
class Attribute:
    """An attribute of MJCF, added to in a description (MjSpec) or in a compiled model (MjModel).

    Attributes:
        element: what has it.
        name: in MJCF and in [[parameters]] of a machine's file: "frictionloss".
        array: of the compiled model; one by degree of freedom has the joint's first one.
        column: of a row of that array; None where it has one number for each.
        sign: -1 where the array has minus the number.
        against: column of `actuator_biasprm` that has minus the number as well; without it there
            the model does not have the attribute.
    """

    element: Element
    name: str
    array: str
    column: int | None = None
    sign: float = 1.0
    against: int | None = None

    def read(self, model: mujoco.MjModel, target: str) -> float:
        """The number, in the model."""
        value = self.sign * float(getattr(model, self.array)[self.entry(model, target)])
        if self.against is None:
            return value
        bias = float(model.actuator_biasprm[model.actuator(target).id, self.against])
        return value if bias == -value else 0.0

    def add(self, model: mujoco.MjModel, target: str, size: float) -> None:
        """Add to the number of a compiled model."""
        getattr(model, self.array)[self.entry(model, target)] += self.sign * size
        if self.against is not None:
            model.actuator_biasprm[model.actuator(target).id, self.against] -= size

    def add_to_spec(self, spec: mujoco.MjSpec, target: str, size: float) -> None:
        """Add to the number of a joint's description; of a polynomial, to its first order."""
        joint = spec.joint(target)
        before = getattr(joint, self.name)
        after = before + size if np.ndim(before) == 0 else before + size * np.eye(3)[0]
        setattr(joint, self.name, after)

    def entry(self, model: mujoco.MjModel, target: str) -> int | tuple[int, int]:
        """Where in the array."""
        if self.name in ("centre", "place"):
            body, _, axis = target.rpartition(".")
            return int(model.body(body).id), "xyz".index(axis)
        if self.array.startswith("dof_"):
            return int(model.joint(target).dofadr[0])
        number = int(getattr(model, str(self.element))(target).id)
        return number if self.column is None else (number, self.column)


@dataclass(frozen=True)
class Log:
    """A signal as the recorder writes it; the machine itself stays as it is."""

    signal: str


Change = Table | Loop | Attribute | Log

DAMPING = Attribute(Element.JOINT, "damping", "dof_damping")
FRICTION_LOSS = Attribute(Element.JOINT, "frictionloss", "dof_frictionloss")
ARMATURE = Attribute(Element.JOINT, "armature", "dof_armature")
STIFFNESS = Attribute(Element.JOINT, "stiffness", "jnt_stiffness")
CUBIC_STIFFNESS = Attribute(Element.JOINT, "cubic_stiffness", "jnt_stiffnesspoly", 1)
PLACE = Attribute(Element.BODY, "place", "body_pos")
GAIN = Attribute(Element.ACTUATOR, "gain", "actuator_gainprm", 0)
SERVO_STIFFNESS = Attribute(Element.ACTUATOR, "kp", "actuator_gainprm", 0, against=1)
SERVO_DAMPING = Attribute(Element.ACTUATOR, "kv", "actuator_biasprm", 2, sign=-1.0)
LAG = Attribute(Element.ACTUATOR, "timeconst", "actuator_dynprm", 0)
MASS = Attribute(Element.BODY, "mass", "body_mass")
CENTRE = Attribute(Element.BODY, "centre", "body_ipos")
