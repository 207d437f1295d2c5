"""Match: a column of a log and the spot of a model that it is taken for."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import linear_sum_assignment

from ves_twin.core.units import to_unit
from ves_twin.data.formats.unit_names import bare_name, spelled
from ves_twin.data.mapping.column_expression import quoted
from ves_twin.machines.mjcf.draft.log_columns import LogColumns
from ves_twin.machines.mjcf.draft.names import (
    ENOUGH,
    INDIRECT,
    PLACED,
    PRESSURES,
    Likeness,
    called,
    implied_unit,
    is_setpoint,
    likeness,
)
from ves_twin.machines.mjcf.draft.spots import Quantity, Spot, words_of
from ves_twin.machines.mjcf.rig.column import LAB_UNITS

RIVAL = 2.0
"""A rival is worth telling where its likeness is less than this below: one piece of evidence."""

MOST_OTHERS = 4
"""Rivals that are told: of a whole robot thirty joints are called as one of its arm."""

LENGTHS, ANGLES = frozenset({"m", "mm", "cm"}), frozenset({"rad", "deg"})
"""Units of positions that a joint of the other kind does not have."""


@dataclass(frozen=True)
class Match:
    """A column taken for a spot.

    Attributes:
        column: of the log.
        spot: of the model.
        unit: of the column's numbers; the spot's where nobody says one.
        told: whether file or name give the unit.
        scale: the spot's number is scale times the column in its unit.
        reasons: why.
        others: what else the column could be, or which column would do as well.
        alone: the column itself, where `column` is a difference with another.
        zero: the spot's number where the column is zero [SI].
        given: whether its owner says the scale.
    """

    column: str
    spot: Spot
    unit: str
    told: bool
    scale: float
    reasons: tuple[str, ...]
    others: tuple[str, ...] = ()
    alone: str = ""
    zero: float = 0.0
    given: bool = False

    @property
    def indirect(self) -> bool:
        """Whether a constant that no unit tells stands between the column and the spot."""
        effort = self.spot.quantity is Quantity.EFFORT
        return effort and self.told and self.unit in INDIRECT and self.spot.unit != self.unit

    @property
    def kind(self) -> str:
        """What such a column is, for people."""
        return "a pressure" if self.unit in PRESSURES else "electrical"

    @property
    def asked(self) -> str:
        """What its constant is on the machine."""
        return "the piston's area" if self.unit in PRESSURES else "the motor's constant"

    @property
    def fitted(self) -> bool:
        """Whether that constant is one that the log gave, and no model's own command."""
        return self.indirect and not (self.spot.unit == "1" and abs(self.scale) == self.prefix)

    @property
    def constant(self) -> str:
        """What the column is multiplied with, where `fitted`, and whether the log told it."""
        told = f"{abs(self.scale):.3g} {self.per}"
        return f"{told}, as nothing tells it" if abs(self.scale) == 1.0 else f"fitted: {told}"

    @property
    def per(self) -> str:
        """Unit of that constant; a command of the model may have none."""
        own = "of the model's command" if self.spot.unit == "1" else self.spot.unit
        return f"{own} per {self.unit}"

    @property
    def prefix(self) -> float:
        """Of an electrical unit: a model's own command is in amperes or volts."""
        return 1e-3 if self.unit in ("mA", "mV") else 1.0

    def less(self, other: Match, along: float) -> Match:
        """As the difference to another column of the same unit, whose axis points `along` (+-1)."""
        one, two = (m.alone or m.column for m in (self, other))
        sign = "-" if along * self.scale * other.scale > 0.0 else "+"
        return replace(self, column=f"{quoted(one)} {sign} {quoted(two)}", alone=one)

    @property
    def factor(self) -> float:
        """What the column is multiplied with to give the spot's number in SI."""
        if self.indirect or LAB_UNITS.get(self.unit, self.unit) != self.spot.unit:
            return self.scale
        return self.scale * to_unit(self.unit, self.spot.unit, self.column)[0]


@dataclass(frozen=True)
class Matches:
    """All of a log.

    Attributes:
        found: columns with their spots, in the order of the model.
        setpoints: columns that say what was asked for.
        left: columns that fit no spot, each with the reason.
    """

    found: tuple[Match, ...]
    setpoints: tuple[str, ...]
    left: Mapping[str, str]

    def of(self, quantity: Quantity) -> list[Match]:
        """Of one quantity."""
        return [m for m in self.found if m.spot.quantity is quantity]


def matched(log: LogColumns, spots: Sequence[Spot]) -> Matches:
    """The assignment of columns to spots with the greatest sum of evidence.

    A column is matched where two pieces of evidence speak for it; what is not stays in `left`.
    """
    columns = list(log.values)
    alike = {
        (c, s): found for c in columns for s in spots if (found := _likeness(log, c, s, spots))
    }
    score = np.zeros((len(columns), len(spots)))
    for i, column in enumerate(columns):
        for k, spot in enumerate(spots):
            found = alike.get((column, spot))
            score[i, k] = max(found.score, 0.0) if found else 0.0
    rows, places = linear_sum_assignment(score, maximize=True)
    chosen = {
        columns[i]: spots[k] for i, k in zip(rows, places, strict=True) if score[i, k] >= ENOUGH
    }
    last = _last(columns, spots, alike, chosen)
    chosen = _whole_sensors(chosen | last, spots)
    found_ = [_match(log, c, s, alike, chosen) for c, s in chosen.items()]
    left_over = "the only one left, as is its joint"
    found_ = [
        replace(m, reasons=(*m.reasons, left_over)) if m.column in last else m for m in found_
    ]
    order = {spot: i for i, spot in enumerate(spots)}
    found_.sort(key=lambda m: order[m.spot])
    rest = [c for c in columns if c not in chosen]
    setpoints = tuple(c for c in rest if is_setpoint(log.said[c]))
    left = {c: _reason(c, _unit(log, c), spots, alike) for c in rest if c not in setpoints}
    left |= dict.fromkeys(log.constant, "never changes")
    left |= dict.fromkeys(log.empty, "has rows without a number")
    return Matches(tuple(found_), setpoints, left)


def _last(
    columns: Sequence[str],
    spots: Sequence[Spot],
    alike: Mapping[tuple[str, Spot], Likeness],
    chosen: Mapping[str, Spot],
) -> dict[str, Spot]:
    """The one column left whose name is of a position, for the one joint left without one."""
    open_ = [
        s for s in spots if s.quantity is Quantity.POSITION and s not in chosen.values() and s.moves
    ]
    named = [c for c in columns if c not in chosen and not is_setpoint(c)]
    named = [c for c in named if any((c, s) in alike and alike[c, s].score > 0.0 for s in open_)]
    named = [c for c in named if PLACED & set(words_of(bare_name(c)))]
    return dict(zip(named, open_, strict=True)) if len(named) == len(open_) == 1 else {}


def _likeness(log: LogColumns, column: str, spot: Spot, spots: Sequence[Spot]) -> Likeness | None:
    rivals = [s for s in spots if (s.quantity, s.unit) == (spot.quantity, spot.unit)]
    names = {c: bare_name(log.called.get(c, c)) for c in log.values}
    stem = re.sub(r"\d+", "#", names[column])
    family = [name for name in names.values() if re.sub(r"\d+", "#", name) == stem]
    zero = any(re.findall(r"\d+", name)[-1:] == ["0"] for name in family)
    zero = zero and not any(re.findall(r"\d+", s.name)[-1:] == ["0"] for s in rivals)
    spot = _numbered(spot, rivals, len(family))
    return likeness(log.said[column], _unit(log, column), spot, len(rivals) == 1, zero)


def _numbered(spot: Spot, rivals: Sequence[Spot], columns: int) -> Spot:
    """With its place as its number, where more columns are numbered than names are alike.

    Six columns q1 to q6 of shoulder, elbow, wrist_1 to wrist_3 count all joints: wrist_1 is no
    first. Two of a leg1 and a leg2 count those.
    """
    numbers = [s.number for s in rivals]
    alike = Counter(re.sub(r"\d+", "#", s.name) for s in rivals)
    if len(set(numbers)) == len(numbers) or columns <= max(alike.values()):
        return spot
    return replace(spot, number=rivals.index(spot) + 1)


def _unit(log: LogColumns, column: str) -> str:
    """As the file or the name says it, or implies it; empty if neither does."""
    return log.units.get(column, "") or implied_unit(log.said[column])


def _whole_sensors(chosen: dict[str, Spot], spots: Sequence[Spot]) -> dict[str, Spot]:
    """Without sensors of which not every number has a column, but for one column of one axis.

    Of three numbers one column alone is the one that its name says, or the only one that moves.
    """
    there = [(s.name, s.axis) for s in chosen.values() if s.quantity is Quantity.SENSOR]
    counts = {name: sum(n == name for n, _ in there) for name, _ in there}
    found = {}
    for column, spot in chosen.items():
        if spot.quantity is not Quantity.SENSOR or counts[spot.name] == spot.width:
            found[column] = spot
            continue
        if spot.width != len("xyz"):
            continue
        own = [s for s in spots if (s.quantity, s.name) == (spot.quantity, spot.name)]
        said = [s for s in own if "xyz"[s.axis] in words_of(bare_name(column))]
        likely = said or [s for s in own if s.moves]
        if counts[spot.name] == 1 and len(likely) == 1:
            found[column] = likely[0]
    return found


def _match(
    log: LogColumns,
    column: str,
    spot: Spot,
    alike: Mapping[tuple[str, Spot], Likeness],
    chosen: Mapping[str, Spot],
) -> Match:
    own, unit = alike[column, spot], spelled(_unit(log, column))
    near, words = own.score - RIVAL, words_of(bare_name(column))
    whole = called(words, spot)
    others = [
        f"it could be {s.label}"
        for (c, s), found in alike.items()
        if c == column and s != spot and s.moves and found.score > near and s not in chosen.values()
        if called(words, s) or not whole
    ]
    others += [
        f"{c} would do as well"
        for (c, s), found in alike.items()
        if s == spot and c != column and found.score > near and c not in chosen
    ]
    if len(others) > MOST_OTHERS:
        others[MOST_OTHERS - 1 :] = [f"{len(others) - MOST_OTHERS + 1} more could be"]
    return Match(column, spot, unit or spot.unit, bool(unit), 1.0, own.reasons, tuple(others))


def _reason(
    column: str, unit: str, spots: Sequence[Spot], alike: Mapping[tuple[str, Spot], Likeness]
) -> str:
    """Why a column is left over: an arm's deflection in metres is no angle of its hinge."""
    words = words_of(bare_name(column))
    for spot in spots:
        named = {w for w in words_of(spot.name) if len(w) > 1 and not w.isdigit()}
        other = spelled(unit) in LENGTHS if spot.unit == "rad" else spelled(unit) in ANGLES
        if spot.quantity is Quantity.POSITION and other and named and named <= set(words):
            return (
                f"joint {spot.name} has this name, but its position is in {spot.unit}, not in"
                f" {unit}: convert the column, or give the model the other kind of joint"
            )
    near = [(f.score, s) for (c, s), f in alike.items() if c == column and f.score > 0.0]
    if not near:
        return "nothing in the model has this name or unit"
    best = max(near, key=lambda pair: pair[0])[1]
    return f"nearest is {best.label}"
