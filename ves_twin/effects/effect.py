"""Effect: one physical deviation on one target, an edit of the model or of the loop."""

from __future__ import annotations

import math
from abc import ABC
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.types import FloatArray
from ves_twin.core.units import unit_tail
from ves_twin.effects.magnitude import Magnitude

if TYPE_CHECKING:
    import mujoco
    import numpy as np

LEGS = tuple(f"leg.{i}" for i in range(1, 7))
AXES = tuple(f"sensor.{axis}" for axis in ("fx", "fy", "fz", "mx", "my", "mz"))
JOINTS = tuple(f"arm.q{i}" for i in range(1, 4))
LINKS = tuple(f"arm.link{i}" for i in range(1, 4))
RIG = ("rig",)
ALL_LEGS = ("legs",)


@dataclass(frozen=True)
class Effect(ABC):
    """A named deviation; a concrete class adds its magnitudes as fields and overrides one hook.

    With every magnitude zero a hook must change nothing, to the last bit. Effects of one plant
    add up; a plant holds at most one of a kind on a target.

    Attributes:
        target: where it sits, one of `targets`: "leg.3", "sensor.fz", "arm.q2", "rig".

    Raises:
        UnknownNameError: a target that this kind does not have.
        InvalidInputError: a magnitude that is not finite or out of bounds.
    """

    target: str

    kind: ClassVar[str]
    targets: ClassVar[tuple[str, ...]]
    magnitudes: ClassVar[tuple[Magnitude, ...]]
    channels: ClassVar[tuple[str, ...]]
    source: ClassVar[str]

    def __post_init__(self) -> None:
        if self.target not in self.targets:
            raise UnknownNameError(f"target of {self.kind}", str(self.target), self.targets)
        for magnitude in self.magnitudes:
            value = getattr(self, magnitude.name)
            number = isinstance(value, int | float) and not isinstance(value, bool)
            if not number or not math.isfinite(value):
                raise InvalidInputError(self._of(magnitude), value, "a finite number")
            if not magnitude.low <= value <= magnitude.high:
                tail = unit_tail(magnitude.unit)
                bounds = f"{magnitude.low:g} to {magnitude.high:g}{tail}"
                raise InvalidInputError(self._of(magnitude), value, bounds)

    @property
    def index(self) -> int:
        """Number of the target in the rig's arrays, from 0."""
        return self.targets.index(self.target)

    @property
    def values(self) -> dict[str, float]:
        """Magnitudes by name, in their units."""
        return {m.name: float(getattr(self, m.name)) for m in self.magnitudes}

    @property
    def neutral(self) -> bool:
        """Whether every magnitude is zero."""
        return not any(self.values.values())

    def edit_numbers(self, numbers: dict[str, FloatArray]) -> None:
        """Change values of the plant's parameter table, by their dotted names."""

    def edit_arm(self, arm: mujoco.MjSpec) -> None:
        """Change the arm's part before it is attached; it also shapes the zero-g reference."""

    def edit_rig(self, rig: mujoco.MjSpec) -> None:
        """Change the whole rig before it is compiled."""

    def edit_loop(self, parameters: np.void) -> None:
        """Change the numbers of the compiled loop: valve, cylinder, sensors, deployed leg loop."""

    def edit_computers(self, numbers: dict[str, FloatArray]) -> None:
        """Change numbers of the admittance computer's program.

        Args:
            numbers: "gravity.age" in cycles (), and where a system is emulated "emulated.mass", M
                of the model that runs (6, 6).
        """

    def _of(self, magnitude: Magnitude) -> str:
        return f"{self.kind} of {self.target}: {magnitude.name}"
