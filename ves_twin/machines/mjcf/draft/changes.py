"""changes: ways in which the columns of a log may be meant otherwise, each with words for it."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from itertools import combinations

import mujoco
import numpy as np

from ves_twin.machines.mjcf.draft.match import Match
from ves_twin.machines.mjcf.draft.spots import Quantity
from ves_twin.machines.mjcf.parts.predecessor import predecessor
from ves_twin.machines.mjcf.plausible.readings import TURNS
from ves_twin.machines.mjcf.rig.places import driven_joint

DEGREE, TURN = np.pi / 180.0, 2.0 * np.pi

OTHER_ANGLE = {"deg": "rad", "rad": "deg"}

HALF_TURN = np.pi
"""Angle up to which numbers named degrees may be radians: a joint seldom turns round more."""

FAR_ROUND = 8.0 * np.pi
"""Angle from which numbers named radians may be degrees: 25 degrees are such, four turns are few
joints'."""

Change = tuple[list[Match], str]
"""All columns as they would be meant, and words for it."""


def changes(
    found: list[Match], driven: set[str], model: mujoco.MjModel, reach: Mapping[str, float]
) -> Iterator[Change]:
    """Positions turned, in other units, from the world, before a gear, from another zero; swaps.

    Positions are exchanged where an effort tells the one joint from the other.

    Args:
        found: columns as they are meant now.
        driven: joints whose efforts were recorded.
        model: that they are held against.
        reach: column of a position -> its largest number.
    """
    positions = [m for m in found if m.spot.quantity is Quantity.POSITION and not m.given]
    for match in positions:
        words = f"{match.column} counts against {match.spot.label} of the model: it is turned"
        yield _with(found, {match: replace(match, scale=-match.scale)}), words
    odd = {m for m in positions if m.spot.name in driven or misnamed(m, reach.get(m.column, 0.0))}
    yield from _in_units(found, positions, odd)
    yield from _from_the_world(found, positions, model)
    yield from _before_gears(found, positions, model)
    yield from _from_another_zero(found, positions)
    efforts = [m for m in found if m.spot.quantity is Quantity.EFFORT and not m.given]
    for one, two in (*combinations(positions, 2), *combinations(efforts, 2)):
        told = one in efforts or {one.spot.name, two.spot.name} & driven
        if told and (one.spot.unit, one.unit) == (two.spot.unit, two.unit):
            words = f"{one.column} and {two.column} look swapped"
            new = {one: _at(two, one), two: _at(one, two)}
            yield _with(found, new), f"{words}: taken the other way round"
            speeds = {m.spot.name: m for m in found if m.spot.quantity is Quantity.SPEED}
            if one in positions and {one.spot.name, two.spot.name} <= set(speeds):
                a, b = speeds[one.spot.name], speeds[two.spot.name]
                new |= {a: _at(b, a), b: _at(a, b)}
                yield _with(found, new), f"{words}, their speeds too: taken the other way round"


def _with(found: list[Match], new: Mapping[Match, Match]) -> list[Match]:
    return [new.get(m, m) for m in found]


def _at(match: Match, other: Match) -> Match:
    """With the spot of another."""
    return replace(match, spot=other.spot, reasons=("fits the model better there",))


def misnamed(match: Match, most: float) -> bool:
    """Whether numbers of an angle are as large as those of its other unit."""
    return most < HALF_TURN if match.unit == "deg" else most > FAR_ROUND


def _in_units(
    found: list[Match], positions: list[Match], odd: Collection[Match]
) -> Iterator[Change]:
    """Numbers without a told unit in another one; degrees that are radians.

    What a name says stands where no effort of that joint speaks, unless the numbers do (`odd`): an
    elbow on a belt was taken for 57 times smaller, as it then explained its shoulder.
    """
    for factor, unit, kind in ((DEGREE, "deg", "rad"), (TURN, "turn", "rad"), (0.001, "mm", "m")):
        open_ = [m for m in positions if m.spot.unit == kind and not m.told and m.unit == kind]
        for group in _groups(open_):
            if unit == "turn" and len(group) == 1:  # a mass that is wrong would do as well
                continue
            names = ", ".join(m.column for m in group)
            words = f"numbers fit the model as {unit}, not as {kind} (factor {factor:.4g})"
            new = {m: replace(m, unit=unit) for m in group}
            yield _with(found, new), f"{names}: {words}"
    for one, other in OTHER_ANGLE.items():
        named = [m for m in positions if m.told and m.unit == one and m in odd]
        for group in _groups(named):
            names = ", ".join(m.column for m in group)
            words = f"{names}: named in {one}, the numbers fit the model as {other}"
            yield _with(found, {m: replace(m, unit=other) for m in group}), words


def _groups(matches: list[Match]) -> list[list[Match]]:
    """Each alone, and all together."""
    return [[m] for m in matches] + [matches] * (len(matches) > 1)


def _from_the_world(
    found: list[Match], positions: list[Match], model: mujoco.MjModel
) -> Iterator[Change]:
    """Angles as an inclinometer or a camera tells them: a joint's own is a difference of two."""
    own = {m.spot.name: m for m in positions}
    new: dict[Match, Match] = {}
    for joint, match in own.items():
        before = predecessor(model, joint, own)
        if before is None or match.alone:
            continue
        other, along = own[before[0]], before[1]
        if match.unit == other.unit and abs(match.scale) == abs(other.scale):
            new[match] = match.less(other, along)
    for group in _groups(list(new)):
        names = ", ".join(m.column for m in group)
        formulas = ", ".join(new[m].column for m in group)
        words = f"numbers fit the model as measured from the world: {formulas}"
        yield _with(found, {m: new[m] for m in group}), f"{names}: {words}"


def _before_gears(
    found: list[Match], positions: list[Match], model: mujoco.MjModel
) -> Iterator[Change]:
    """Angles of motors, whose gear stands in the model."""
    gears = {driven_joint(model, i): abs(float(model.actuator_gear[i, 0])) for i in range(model.nu)}
    for match in positions:
        gear = gears.get(match.spot.name, 1.0)
        if gear in (0.0, 1.0) or abs(match.scale) != 1.0:
            continue
        if match.told and match.spot.unit == "m":  # a motor's angle has no unit of length
            continue
        words = f"numbers fit the model as those of the motor, before its gear of {gear:g}"
        new = replace(match, scale=match.scale / gear)
        yield _with(found, {match: new}), f"{match.column}: {words}"


def _from_another_zero(found: list[Match], positions: list[Match]) -> Iterator[Change]:
    """Angles that are zero where the model's joint is a quarter or half a turn away."""
    for match in positions:
        if match.spot.unit != "rad" or match.zero:
            continue
        for name, turn in TURNS.items():
            words = f"{match.column}: zero where the model's joint is at {name}: that is added"
            yield _with(found, {match: replace(match, zero=turn)}), words
