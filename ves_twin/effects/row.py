"""Row and Anywhere: where a kind of effect can sit, what it changes there, and how large it is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum, auto

from ves_twin.effects.change import Attribute, Change, Table
from ves_twin.effects.element import Element
from ves_twin.effects.magnitude import Magnitude
from ves_twin.effects.place import Place
from ves_twin.effects.size import Size

LEGS = tuple(f"leg.{i}" for i in range(1, 7))
AXES = tuple(f"sensor.{axis}" for axis in ("fx", "fy", "fz", "mx", "my", "mz"))
JOINTS = tuple(f"arm.q{i}" for i in range(1, 4))
LINKS = tuple(f"arm.link{i}" for i in range(1, 4))
RIG = ("rig",)
ALL_LEGS = ("legs",)
COMPUTERS = ("computers",)
"""Targets on VES II."""

LEAST = 0.001
"""Smallest size of interest, as a share of the largest, where a kind says nothing else."""

Length = float | Callable[[Place], float]
"""A number, or what makes one of a place's typical sizes."""


class Part(IntEnum):
    """Parts of VES II, in the order of its library: the draws of the blind suites rest on it."""

    VALVE = auto()
    CYLINDER = auto()
    SUPPLY = auto()
    TRANSDUCER = auto()
    STRUCTURE = auto()
    SENSOR = auto()
    PAYLOAD = auto()
    ARM = auto()
    CLOCK = auto()
    DRIVE = auto()
    PROGRAM = auto()
    COMPUTERS = auto()
    OTHER = auto()


_UNDER_PRESSURE = ("chamber.", "supply.")


@dataclass(frozen=True)
class Row:
    """A kind of effect on some targets of VES II.

    Attributes:
        targets: names in files: "leg.3", "sensor.fz", "arm.q2", "rig".
        span: sd that commissioning leaves open, smallest size of interest, largest plausible one,
            in the unit of the size.
        channels: where it shows first.
        change: the one number that it changes; None where the kind has hooks of its own.
        part: of the machine; what sits on its arm turns, what sits on its legs slides.
        source: why these sizes; that of the kind if left out.
    """

    targets: tuple[str, ...]
    span: tuple[float, float, float]
    channels: tuple[str, ...]
    change: Change | None = None
    part: Part = Part.OTHER
    source: str = ""

    @property
    def pressure(self) -> bool:
        """Whether it acts on chambers or the manifold, which the linear form lacks."""
        return isinstance(self.change, Table) and self.change.name.startswith(_UNDER_PRESSURE)

    def magnitude(self, size: Size) -> Magnitude:
        """A size with unit and range."""
        unit = size.unit_on(hinge=self.part is Part.ARM)
        return Magnitude(size.name, unit, *self.span, size.sign)


@dataclass(frozen=True)
class Anywhere:
    """A kind of effect on any machine of an MJCF model.

    Attributes:
        element: what it sits on.
        largest: plausible size.
        smallest: size of interest; LEAST of the largest if None.
        attribute: the number of the model that it adds to; its nominal value is the model's.
        columns: numbers at the end of a target that is a signal: "wrist.force.3" has one.
        axis: whether the target ends in an axis of the body: "tool.x".
        linear: whether its trace is proportional to its size.
        transient: whether its sizes belong to one stretch of time and say nothing of later ones.
        source: why these sizes.
    """

    element: Element
    largest: Length = 0.0
    smallest: Length | None = None
    attribute: Attribute | None = None
    columns: int = 1
    axis: bool = False
    linear: bool = False
    transient: bool = False
    source: str = "assumed: sizes follow from the typical ones of the rig's file"

    def magnitude(self, size: Size, place: Place) -> Magnitude:
        """A size at a place, absent by declaration (sd 0)."""
        unit = size.unit_on(hinge=place.hinge, signal=place.unit)
        largest = _number(self.largest, place)
        smallest = LEAST * largest if self.smallest is None else _number(self.smallest, place)
        return Magnitude(size.name, unit, 0.0, smallest, largest, size.sign, size.component)


def _number(length: Length, place: Place) -> float:
    return length(place) if callable(length) else length
