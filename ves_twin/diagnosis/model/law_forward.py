"""LawForward: a plant in which laws can act; LawPlace, where one may, and of what."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.diagnosis.model.invertible import Invertible
from ves_twin.effects.law import Law, LawKind

STEP = 0.02
"""Finite difference of a law's number, in expected sizes."""


@dataclass(frozen=True)
class Variable:
    """What a law may depend on: its name, as "speed@joint", and its unit."""

    name: str
    unit: str

    @property
    def what(self) -> str:
        """position, speed, time or command."""
        return self.name.partition("@")[0]


@dataclass(frozen=True)
class LawPlace:
    """A joint or a column.

    Attributes:
        name: joint, two joints, as `Law` has them, or channel.
        kind: effort or reading.
        unit: of the law.
        scale: size that a law is expected to have there [unit].
        variables: on which it may depend, the nearest first.
        step: finite difference of a law's size, in expected sizes.
    """

    name: str
    kind: LawKind
    unit: str
    scale: float
    variables: tuple[Variable, ...]
    step: float = STEP


@runtime_checkable
class LawForward(Invertible, Protocol):
    """A `Forward` in which laws can act: two more verbs, and a simulation that takes laws."""

    def simulate(
        self,
        programme: Excitation,
        values: Mapping[str, float],
        refined: bool = False,
        laws: Sequence[Law] = (),
    ) -> FloatArray:
        """See `Forward`; with laws at work beside those that the plant has."""

    def law_places(self) -> tuple[LawPlace, ...]:
        """Where a law may act."""

    def visited(
        self, programme: Excitation, values: Mapping[str, float], laws: Sequence[Law] = ()
    ) -> Mapping[str, FloatArray]:
        """What moves (n,), by name: every variable of the places that is no sum and no play."""
