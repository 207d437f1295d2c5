"""RigEffect: one deviation at a joint, actuator, body or signal of any rig."""

from __future__ import annotations

import math
from abc import ABC
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.effects.magnitude import Magnitude
from ves_twin.machines.mjcf.element import Element
from ves_twin.machines.mjcf.place import Place
from ves_twin.machines.mjcf.size import Size

if TYPE_CHECKING:
    import mujoco


@dataclass(frozen=True)
class RigEffect(ABC):
    """A named deviation; a concrete class adds its sizes as fields and overrides its hooks.

    A size is a departure from what the model has, so that zero is always "no effect"; with every
    size zero a hook must change nothing, to the last bit.

    Attributes:
        target: name of the joint, actuator, body or signal.

    Raises:
        InvalidInputError: a size that is not a finite number.
    """

    target: str

    kind: ClassVar[str]
    element: ClassVar[Element]
    size: ClassVar[Size]
    """Of a kind with one number; a kind with more overrides `magnitudes`."""
    attribute: ClassVar[str] = ""
    """Attribute of the model that it changes; its nominal value is then that of the model."""
    source: ClassVar[str] = "assumed: sizes follow from the typical ones of the rig's file"
    linear: ClassVar[bool] = False
    transient: ClassVar[bool] = False
    """Whether its sizes belong to one stretch of time and say nothing of later ones."""

    def __post_init__(self) -> None:
        for name, value in self.sizes.items():
            if not math.isfinite(value):
                raise InvalidInputError(f"{self.kind} of {self.target}: {name}", value, "a number")

    @classmethod
    def magnitudes(cls, place: Place) -> tuple[Magnitude, ...]:
        """Sizes with unit and range at a place."""
        return (cls.size.at(place),)

    @classmethod
    def starts(cls, place: Place) -> tuple[tuple[float, ...], ...]:
        """Sizes to begin a search at, where sizes say nothing one by one; () if they do."""
        return ()

    @property
    def sizes(self) -> dict[str, float]:
        """Departures by name."""
        return {f.name: float(getattr(self, f.name)) for f in fields(self) if f.name != "target"}

    def sized(self, sizes: Mapping[str, float]) -> RigEffect:
        """Of the same kind on the same target, at other sizes."""
        return type(self)(self.target, **sizes)

    @property
    def neutral(self) -> bool:
        """Whether every size is zero."""
        return not any(self.sizes.values())

    def least(self, nominal: float) -> float:
        """Smallest value of a size beside its nominal one; below it no machine can be."""
        return -math.inf

    def present(self, model: mujoco.MjModel) -> float:
        """What the model has of its attribute; sizes are departures from that."""
        return 0.0

    def edit_model(self, model: mujoco.MjModel) -> None:
        """Change the compiled model."""

    def resist(self, speed: FloatArray, slow: float) -> FloatArray:
        """Effort [N, N m] against a joint's motion at speeds (n,); `slow` smooths signs."""
        return np.zeros_like(speed)

    def hold(self, position: FloatArray) -> FloatArray:
        """Effort [N, N m] against a joint along positions (n,), of a kind with place or memory."""
        return np.zeros_like(position)

    def holder(self) -> Callable[[float], float]:
        """The same, position by position from where the motion begins; it keeps the memory."""
        return lambda position: 0.0

    def edit_position(self, position: FloatArray) -> FloatArray:
        """A joint's position (n,) on the other side of what lies between drive and joint."""
        return position

    def edit_command(self, command: FloatArray, time: FloatArray) -> FloatArray:
        """What an actuator gives of its command (n,)."""
        return command

    def edit_row(self, command: FloatArray, time: FloatArray, row: int) -> float:
        """What an actuator gives in one row of a closed loop, which knows no later commands.

        By `edit_command` of all up to there; an effect that knows a shorter way has its own.

        Args:
            command: to the actuator (n,), filled up to the row.
            time: of the rows [s] (n,).
            row: which one.
        """
        if type(self).edit_command is RigEffect.edit_command:
            return float(command[row])
        return float(self.edit_command(command[: row + 1], time[: row + 1])[row])

    def edit_required(self, effort: FloatArray, time: FloatArray) -> FloatArray:
        """The command (n,) that an actuator needs to give an effort."""
        return effort

    def edit_reading(
        self, reading: FloatArray, true: FloatArray, time: FloatArray, place: Place
    ) -> FloatArray:
        """What is read (n, w) of a signal whose true values are (n, w)."""
        return reading

    @property
    def setting(self) -> tuple[str, str]:
        """Element and attribute that stand for it in [[parameters]]: "tool", "centre_x"."""
        if self.attribute != "centre":
            return self.target, self.attribute
        name, _, axis = self.target.rpartition(".")
        return name, f"centre_{axis}"

    @property
    def column(self) -> int:
        """Column of a signal, from 0: the last number of the target."""
        return int(self.target.rpartition(".")[2]) - 1


def shifted(values: FloatArray, time: FloatArray, delay: float) -> FloatArray:
    """Values (n,) or (n, w) a delay [s] ago, linear between rows, ends held."""
    if delay == 0.0:
        return values
    if values.ndim == 1:
        return np.asarray(np.interp(time - delay, time, values))
    return np.stack([np.interp(time - delay, time, column) for column in values.T], axis=1)


def play(position: FloatArray, gap: float) -> FloatArray:
    """The driven side of a lost motion: it follows at the ends of a gap, else it rests.

    y[k] = min(max(y[k-1], x[k] - g/2), x[k] + g/2): the play operator.

    Source: Krasnosel'skii and Pokrovskii 1989, Systems with Hysteresis.
    """
    if gap == 0.0:
        return position
    half, driven = 0.5 * abs(gap), np.empty_like(position)
    y = float(position[0])
    for k, x in enumerate(position.tolist()):
        y = min(max(y, x - half), x + half)
        driven[k] = y
    return driven
