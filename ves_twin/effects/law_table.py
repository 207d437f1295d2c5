"""LawTable: one entry of `[[laws]]` in a machine's file."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from itertools import pairwise
from typing import Self

from pydantic import Field, model_validator

from ves_twin.core.errors import UnknownNameError
from ves_twin.core.part import Part
from ves_twin.effects.law import Law, LawKind, LawShape, joints_of, parts_of

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

    @staticmethod
    def of_law(law: Law) -> LawTable:
        """At work, as no file has it."""
        own = {name: getattr(law, name) for name in ("place", "kind", "shape", "of", "knots")}
        return LawTable.model_construct(**own, values=law.values)

    def check(
        self, joints: Collection[str], columns: Collection[str], variables: Collection[str]
    ) -> None:
        """Raise UnknownNameError at a place or a variable that a machine does not have."""
        effort = self.kind is LawKind.EFFORT
        for part, _ in joints_of(self.place) if effort else ((self.place, 1.0),):
            if part not in (there := joints if effort else columns):
                raise UnknownNameError(f"place of a law of {self.kind}s", part, there)
        for name in self.of:
            what, parts, _ = parts_of(name)
            for one in [name] if name == "time" else [f"{what}@{joint}" for joint, _ in parts]:
                if one not in variables:
                    raise UnknownNameError(f"variable of the law at {self.place}", one, variables)

    @property
    def name(self) -> str:
        """Of the factor, where it is a cause."""
        return f"{CAUSE}@{self.law.label}:factor"

    def scaled(self, factor: float) -> LawTable:
        """At work, so many times as strong."""
        values = tuple(factor * value for value in self.values)
        return self.model_copy(update={"values": values, "form": "", "cause": False})

    @property
    def words(self) -> str:
        """Kind and form, for people."""
        said = f"{self.kind}, {self.form or self.shape}"
        return f"{said}; a cause, not at work" if self.cause else said

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


def put_over(under: Iterable[LawTable], top: Iterable[LawTable]) -> tuple[LawTable, ...]:
    """Laws of both, one in place of another with the same place and variables."""
    return tuple({(law.place, law.of): law for law in (*under, *top)}.values())
