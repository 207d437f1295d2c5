"""Effect: one physical deviation on one target of a machine, an edit of its model or its loop."""

from __future__ import annotations

import math
from abc import ABC
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, ClassVar, Self

import numpy as np

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.types import FloatArray
from ves_twin.core.units import unit_tail
from ves_twin.effects.change import Attribute, Log, Loop, Table
from ves_twin.effects.element import Element
from ves_twin.effects.magnitude import Magnitude
from ves_twin.effects.place import Place
from ves_twin.effects.resistance import Resistance
from ves_twin.effects.row import ALL_LEGS, AXES, JOINTS, LEGS, LINKS, RIG, Anywhere, Row
from ves_twin.effects.size import Size

if TYPE_CHECKING:
    import mujoco

__all__ = ["ALL_LEGS", "AXES", "JOINTS", "LEGS", "LINKS", "RIG", "Effect"]


@dataclass(frozen=True)
class Effect(ABC):
    """A named deviation; a concrete class has its sizes as fields, and says where it can sit.

    `sizes` has name, unit and sign of each field; `rows` the targets on VES II and `anywhere` the
    elements of other machines, each with ranges and the one number that is changed. A kind that is
    more than a change of one number overrides hooks. A kind on VES II alone may say `targets`,
    `magnitudes`, `channels` and `source` in place of `sizes` and `rows`.

    A size is a departure from what the machine has: with every size zero a hook must change
    nothing, to the last bit. Effects of one machine add up; it holds one of a kind on a target.

    Attributes:
        target: where it sits: "leg.3", "sensor.fz", "arm.q2"; on other machines the name of a
            joint, actuator, body or signal.

    Raises:
        UnknownNameError: a target that a kind of VES II alone does not have.
        InvalidInputError: a size that is not finite; of a kind of VES II alone, out of bounds.
    """

    target: str

    kind: ClassVar[str]
    sizes: ClassVar[tuple[Size, ...]] = ()
    rows: ClassVar[tuple[Row, ...]] = ()
    anywhere: ClassVar[Anywhere | None] = None
    targets: ClassVar[tuple[str, ...]] = ()
    """All of VES II."""
    magnitudes: ClassVar[tuple[Magnitude, ...]] = ()
    channels: ClassVar[tuple[str, ...]] = ()
    source: ClassVar[str] = ""
    proportional: ClassVar[bool] = True
    """Whether its trace on VES II is proportional to its size."""

    def __init_subclass__(cls) -> None:
        if cls.rows:
            cls.rows = tuple(replace(row, source=row.source or cls.source) for row in cls.rows)
            cls.targets = tuple(target for row in cls.rows for target in row.targets)
        elif cls.targets and cls.magnitudes:
            cls.sizes = tuple(Size(m.name, m.unit, m.sign) for m in cls.magnitudes)
            cls.rows = (Row(cls.targets, (0.0, 0.0, 0.0), cls.channels, source=cls.source),)

    def __post_init__(self) -> None:
        for name, value in self._fields().items():
            number = isinstance(value, int | float) and not isinstance(value, bool)
            if not number or not math.isfinite(value):
                raise InvalidInputError(self._of(name), value, "a finite number")
        if self.anywhere is None:
            self.check()

    @classmethod
    def row_of(cls, target: str) -> Row:
        """What the kind is on a target of VES II.

        Raises:
            UnknownNameError: no such target.
        """
        for row in cls.rows:
            if target in row.targets:
                return row
        raise UnknownNameError(f"target of {cls.kind}", str(target), cls.targets)

    @classmethod
    def magnitudes_of(cls, target: str) -> tuple[Magnitude, ...]:
        """Sizes with unit and range on a target of VES II; raises as `row_of`."""
        row = cls.row_of(target)
        return cls.magnitudes or tuple(row.magnitude(size) for size in cls.sizes)

    @classmethod
    def magnitudes_at(cls, place: Place) -> tuple[Magnitude, ...]:
        """Sizes with unit and range at a place of another machine; none where it cannot sit."""
        if cls.anywhere is None:
            return ()
        return tuple(cls.anywhere.magnitude(size, place) for size in cls.sizes)

    @classmethod
    def ranged(cls, place: Place, *largest: float) -> tuple[Magnitude, ...]:
        """Sizes of a kind with several, each with its own largest one at a place."""
        on = [Anywhere(cls.anywhere.element, most) for most in largest] if cls.anywhere else []
        return tuple(one.magnitude(size, place) for one, size in zip(on, cls.sizes, strict=True))

    @classmethod
    def starts(cls, place: Place) -> tuple[tuple[float, ...], ...]:
        """Sizes to begin a search at, where sizes say nothing one by one; () if they do."""
        return ()

    def check(self) -> None:
        """Hold the effect against VES II.

        Raises:
            UnknownNameError: a target that this kind does not have there.
            InvalidInputError: a size out of bounds.
        """
        for magnitude in self.magnitudes_of(self.target):
            value = getattr(self, magnitude.name)
            if not magnitude.low <= value <= magnitude.high:
                tail = unit_tail(magnitude.unit)
                bounds = f"{magnitude.low:g} to {magnitude.high:g}{tail}"
                raise InvalidInputError(self._of(magnitude.name), value, bounds)

    @property
    def parts(self) -> tuple[str, ...]:
        """Names of the elements in its target, where that says more; it acts on the first."""
        return (self.target,)

    @property
    def index(self) -> int:
        """Number of the target among those of its row, from 0."""
        return self.row_of(self.target).targets.index(self.target)

    @property
    def values(self) -> dict[str, float]:
        """Sizes by name, in their units."""
        return {name: float(value) for name, value in self._fields().items()}

    @property
    def neutral(self) -> bool:
        """Whether every size is zero."""
        return not any(self.values.values())

    @property
    def attribute(self) -> Attribute | None:
        """The number of an MJCF model that it adds to, where that is all it does."""
        return self.anywhere.attribute if self.anywhere else None

    @property
    def element(self) -> Element | None:
        """What it sits on, on machines of an MJCF model."""
        return self.anywhere.element if self.anywhere else None

    @property
    def log(self) -> str:
        """The signal of VES II that it changes in the log alone; empty if it is in the rig."""
        change = self.row_of(self.target).change if self.rows else None
        return change.signal if isinstance(change, Log) else ""

    @property
    def label(self) -> str:
        """For people: kind and target."""
        return f"{self.kind} on {self.target}"

    @classmethod
    def meaning(cls) -> str:
        """What it is, in the first line of its class."""
        return (cls.__doc__ or "").strip().splitlines()[0]

    def sized(self, sizes: Mapping[str, float]) -> Self:
        """Of the same kind on the same target, at other sizes."""
        return type(self)(self.target, **sizes)

    def edit_numbers(self, numbers: dict[str, FloatArray]) -> None:
        """Change values of the plant's parameter table, by their dotted names."""
        row = self.row_of(self.target)
        if isinstance(row.change, Table):
            row.change.edit(numbers, self._entry(row), self._size)

    def edit_arm(self, arm: mujoco.MjSpec) -> None:
        """Change the arm's part before it is attached; it also shapes the zero-g reference."""
        change = self.row_of(self.target).change
        if isinstance(change, Attribute):
            change.add_to_spec(arm, self.target.removeprefix("arm."), self._size)

    def edit_rig(self, rig: mujoco.MjSpec) -> None:
        """Change the whole rig before it is compiled."""

    def edit_loop(self, parameters: np.void) -> None:
        """Change the numbers of the compiled loop: valve, cylinder, sensors, deployed leg loop."""
        row = self.row_of(self.target)
        if isinstance(row.change, Loop):
            row.change.edit(parameters, self._entry(row), self._size)

    def edit_computers(self, numbers: dict[str, FloatArray]) -> None:
        """Change numbers of the admittance computer's program.

        Args:
            numbers: "gravity.age" in cycles (), and where a system is emulated "emulated.mass", M
                of the model that runs (6, 6).
        """

    def least(self, nominal: float) -> float:
        """Smallest value of a size beside its nominal one; below it no machine can be."""
        return -math.inf

    def present(self, model: mujoco.MjModel) -> float:
        """What an MJCF model has of its attribute; sizes are departures from that."""
        return self.attribute.read(model, self.target) if self.attribute else 0.0

    def edit_model(self, model: mujoco.MjModel) -> None:
        """Change the compiled model of an MJCF machine."""
        if self.attribute:
            self.attribute.add(model, self.target, self._size)

    @property
    def resistance(self) -> Resistance:
        """Effort against a joint in one of the forms that compiled loops know."""
        return Resistance()

    def resist(self, speed: FloatArray, slow: float) -> FloatArray:
        """Effort [N, N m] against a joint's motion at speeds (n,); `slow` smooths signs."""
        return self.resistance.by_speed(speed, slow)

    def hold(self, position: FloatArray) -> FloatArray:
        """Effort [N, N m] against a joint along positions (n,), of a kind with place or memory."""
        return self.resistance.by_place(position)

    def holder(self) -> Callable[[float], float]:
        """Of a `hold` of its own: the same, position by position; it keeps the memory."""
        return lambda position: 0.0

    def carry(self, load: FloatArray, speed: FloatArray, slow: float) -> FloatArray:
        """Effort [N, N m] against a joint's motion that grows with the load (n,) it carries."""
        return self.resistance.by_load(load, speed, slow)

    def edit_position(self, position: FloatArray) -> FloatArray:
        """A joint's position (n,) on the other side of what lies between drive and joint."""
        return position

    def edit_command(self, command: FloatArray, time: FloatArray) -> FloatArray:
        """What an actuator gives of its command (n,)."""
        return command

    def pick_up(self, commands: Mapping[str, FloatArray]) -> FloatArray | float:
        """What an actuator gets beside its own command of those to others, by their names (n,)."""
        return 0.0

    def edit_row(self, command: FloatArray, time: FloatArray, row: int) -> float:
        """What an actuator gives in one row of a closed loop, which knows no later commands.

        By `edit_command` of all up to there; an effect that knows a shorter way has its own.

        Args:
            command: to the actuator (n,), filled up to the row.
            time: of the rows [s] (n,).
            row: which one.
        """
        if type(self).edit_command is Effect.edit_command:
            return float(command[row])
        return float(self.edit_command(command[: row + 1], time[: row + 1])[row])

    def edit_required(self, effort: FloatArray, time: FloatArray) -> FloatArray:
        """The command (n,) that an actuator needs to give an effort."""
        return effort

    def edit_reading(
        self, reading: FloatArray, true: FloatArray, time: FloatArray, place: Place
    ) -> FloatArray:
        """What is read, or logged, (n, w) of a signal whose true values are (n, w)."""
        return reading

    def undo_reading(self, reading: FloatArray, time: FloatArray, place: Place) -> FloatArray:
        """The true values (n, w) behind what is read, to first order in the effect."""
        return np.asarray(2.0 * reading - self.edit_reading(reading, reading, time, place))

    @property
    def setting(self) -> tuple[str, str]:
        """Element and attribute that stand for it in [[parameters]]: "tool", "centre_x"."""
        attribute = self.attribute.name if self.attribute else ""
        if not (self.anywhere and self.anywhere.axis):
            return self.target, attribute
        name, _, axis = self.target.rpartition(".")
        return name, f"{attribute}_{axis}"

    @property
    def column(self) -> int:
        """Column of a signal, from 0: the last number of the target."""
        return int(self.target.rpartition(".")[2]) - 1

    @property
    def _size(self) -> float:
        (size,) = self._fields().values()
        return size

    def _entry(self, row: Row) -> int | None:
        """Of a number for each target; None where all targets share one."""
        return self.index if len(row.targets) > 1 else None

    def _fields(self) -> dict[str, float]:
        return {f.name: getattr(self, f.name) for f in fields(self) if f.name != "target"}

    def _of(self, name: str) -> str:
        return f"{self.kind} of {self.target}: {name}"
