"""Law: physics that a model lacks, as a function at a place."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from ves_twin.core.compiled import compiled
from ves_twin.core.types import FloatArray, IntArray

SIGNS = {" + ": 1.0, " - ": -1.0}
"""Between two joints that act together, and the sign of the second."""

WITHIN = " within "
"""Between a joint and the width of a play: the variable is where the joint stands in it."""


class LawKind(StrEnum):
    """What a law adds to: the effort of a joint, or what is read of a column."""

    EFFORT = "effort"
    READING = "reading"


class LawShape(StrEnum):
    """How a law follows from its variables.

    TABLE: g(x), linear between knots. MESH: g(x, y), bilinear. STOP: a contact, that pushes back
    with max(0, k p + b dp/dt + a F), p = side (q - q0) deep, F what pushes against it. PLAY: a
    reading that follows within a gap. HOLD: a reading that is renewed every few rows.
    """

    TABLE = "table"
    MESH = "mesh"
    STOP = "stop"
    PLAY = "play"
    HOLD = "hold"


@dataclass(frozen=True)
class Law:
    """An effort or a reading that depends on where a machine is.

    Beyond its knots a law is held: nothing was seen there.

    Attributes:
        place: joint, compared column, or two joints that an effort pushes together, "a + b", or
            against one another, "a - b".
        kind: effort at the joint [N or N m], or what is added to the column [its unit].
        shape: how it follows from its variables.
        of: variables: "time", "position@JOINT", "speed@JOINT", "command@ACTUATOR"; "a + b" or
            "a - b" for JOINT; "position@JOINT within 0.01", where it stands in a play so wide.
        knots: of each variable, rising; () of shapes without.
        values: at the knots, the last variable fastest; of a stop (q0 [m or rad], side +-1,
            k, b, a); of a play its gap; of a hold its rows.
        form: formula, for people; empty of a table.
        source: for people.
    """

    place: str
    kind: LawKind
    shape: LawShape
    of: tuple[str, ...]
    knots: tuple[tuple[float, ...], ...]
    values: tuple[float, ...]
    form: str = ""
    source: str = ""

    @property
    def label(self) -> str:
        """place(variables), for instance "joint(speed@joint)"."""
        return f"{self.place}({', '.join(self.of) or self.shape})"

    def at(self, *variables: FloatArray) -> FloatArray:
        """Values (n,) of a table or a mesh along its variables (n,) each."""
        grid = np.reshape(self.values, [len(k) for k in self.knots])
        if self.shape is LawShape.TABLE:
            return np.asarray(np.interp(variables[0], self.knots[0], grid))
        (i, p), (j, r) = (_between(x, k) for x, k in zip(variables, self.knots, strict=True))
        low = (1.0 - r) * grid[i, j] + r * grid[i, j + 1]
        high = (1.0 - r) * grid[i + 1, j] + r * grid[i + 1, j + 1]
        return np.asarray((1.0 - p) * low + p * high)

    def stopped(self, position: FloatArray, speed: FloatArray) -> FloatArray:
        """Efforts (n,) of a stop along a motion (n,) that is given: the load is in the motion."""
        begin, side, stiffness, damping, _ = self.values
        deep = side * (position - begin)
        push = np.maximum(stiffness * deep + side * damping * speed, 0.0)
        return np.asarray(np.where(deep > 0.0, -side * push, 0.0))

    def read(self, column: FloatArray, *variables: FloatArray) -> FloatArray:
        """A column (n,) as a law of readings has it."""
        if self.shape is LawShape.PLAY:
            return played(column, self.values[0])
        if self.shape is LawShape.HOLD:
            rows = max(1, round(self.values[0]))
            return column[np.arange(len(column)) // rows * rows]
        return column + self.at(*variables)

    def beyond(self, *variables: FloatArray) -> float:
        """Share of the rows at which a variable is beyond the knots."""
        if not self.knots:
            return 0.0
        pairs = zip(variables, self.knots, strict=True)
        return float(np.mean(np.any([(x < k[0]) | (x > k[-1]) for x, k in pairs], axis=0)))


def held_words(law: Law, share: float, rows: str = "rows") -> str:
    """What a person is told of a law that was asked beyond its knots in a share of the rows."""
    return (
        f"the law {law.label} is held in {100.0 * share:.2g} % of the {rows}, which are beyond the"
        " range in which it was seen"
    )


def _between(x: FloatArray, knots: tuple[float, ...]) -> tuple[IntArray, FloatArray]:
    """Number of the knot below, and the share of the way to the next, held at the ends."""
    at = np.asarray(knots)
    held = np.clip(x, at[0], at[-1])
    i = np.clip(np.searchsorted(at, held, side="right") - 1, 0, len(at) - 2)
    return i, (held - at[i]) / (at[i + 1] - at[i])


def joints_of(name: str) -> tuple[tuple[str, float], ...]:
    """Joints that a place or a variable names, each with its sign."""
    for between, sign in SIGNS.items():
        one, found, other = name.partition(between)
        if found:
            return (one, 1.0), (other, sign)
    return ((name, 1.0),)


def parts_of(variable: str) -> tuple[str, tuple[tuple[str, float], ...], float]:
    """What a variable is, its joints with their signs, and the width of its play; 0 for none.

    Raises:
        ValueError: a width that is no number.
    """
    what, _, rest = variable.partition("@")
    joints, _, width = rest.partition(WITHIN)
    return what, joints_of(joints), float(width or 0.0)


def variable_along(name: str, path: Mapping[str, FloatArray]) -> FloatArray:
    """A variable (n,) along what moves, which `path` has by name (n,)."""
    if name in path:
        return path[name]
    what, joints, width = parts_of(name)
    x = np.sum([sign * path[f"{what}@{joint}"] for joint, sign in joints], axis=0)
    return np.asarray(x - played(x, width) if width > 0.0 else x)


def played(column: FloatArray, gap: float) -> FloatArray:
    """Behind a play of a width: what is read moves only when an end of the gap pushes it."""
    return _played(np.ascontiguousarray(column, float), 0.5 * max(gap, 0.0))


@compiled
def _played(column: FloatArray, half: float) -> FloatArray:
    found = np.empty_like(column)
    last = column[0]
    for k in range(len(column)):
        last = min(max(last, column[k] - half), column[k] + half)
        found[k] = last
    return found
