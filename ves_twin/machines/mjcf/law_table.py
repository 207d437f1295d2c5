"""LawTable: one entry of `[[laws]]` in a machine's file."""

from __future__ import annotations

from itertools import pairwise
from typing import Self

from pydantic import Field, model_validator

from ves_twin.effects.law import Law, LawKind, LawShape, parts_of
from ves_twin.scenario.fields import Part

CAUSE = "law"
"""Effect that a law is as a cause."""

FACTORS = (0.02, 2.0)
"""Smallest and largest factor of a law that is a cause: its file has it as it was once found."""

VALUES = {LawShape.STOP: 5, LawShape.PLAY: 1, LawShape.HOLD: 1}
"""Numbers of the shapes that have no knots."""


class LawTable(Part):
    """A law as a file has it, in SI; see docs/laws.md.

    `seen` are the ends of each variable between which it was found; beyond its knots it is held.
    With `cause` it is not at work: it is a cause that a diagnosis may name, by a factor on it.
    """

    place: str
    kind: LawKind
    shape: LawShape = LawShape.TABLE
    of: tuple[str, ...] = ()
    knots: tuple[tuple[float, ...], ...] = ()
    values: tuple[float, ...] = Field(min_length=1)
    form: str = ""
    seen: tuple[tuple[float, float], ...] = ()
    source: str = ""
    cause: bool = False

    @model_validator(mode="after")
    def _fits(self) -> Self:
        if self.shape in VALUES:
            wanted, counts = VALUES[self.shape], 0
        else:
            wanted, counts = 1, {LawShape.TABLE: 1, LawShape.MESH: 2}[self.shape]
            for knots in self.knots:
                wanted *= len(knots)
                if len(knots) < 2 or any(b <= a for a, b in pairwise(knots)):
                    raise ValueError("laws.knots: expected two or more rising numbers")
        if self.shape is LawShape.STOP and not (len(self.of) == 1 and self.kind is LawKind.EFFORT):
            raise ValueError("laws: a stop is an effort and has one variable, a position")
        if self.shape in (LawShape.PLAY, LawShape.HOLD) and self.kind is LawKind.EFFORT:
            raise ValueError(f"laws: a {self.shape} is of a reading")
        if len(self.knots) != counts or (counts and len(self.of) != counts):
            raise ValueError(f"laws: a {self.shape} has {counts} variables with knots each")
        if self.cause and not self.knots:
            raise ValueError("laws.cause: expected a table or a mesh, which a factor can scale")
        if len(self.values) != wanted:
            raise ValueError(f"laws.values: got {len(self.values)}, expected {wanted}")
        return self

    @model_validator(mode="after")
    def _has_widths(self) -> Self:
        for n, name in enumerate(self.of):
            try:
                width = parts_of(name)[2]
            except ValueError as wrong:
                raise ValueError(f"laws.of: no number as the width of a play: '{name}'") from wrong
            if width and n:
                raise ValueError("laws.of: only the first variable may be a place within a play")
        return self

    @property
    def name(self) -> str:
        """Of the factor, where it is a cause."""
        return f"{CAUSE}@{self.law.label}:factor"

    def scaled(self, factor: float) -> LawTable:
        """At work, so many times as strong."""
        values = tuple(factor * value for value in self.values)
        return self.model_copy(update={"values": values, "form": "", "cause": False})

    @property
    def law(self) -> Law:
        """As it is simulated."""
        return Law(
            self.place,
            self.kind,
            self.shape,
            self.of,
            self.knots,
            self.values,
            self.form,
            self.source,
        )
