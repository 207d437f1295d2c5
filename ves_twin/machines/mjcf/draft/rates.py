"""rated, differs: speeds and efforts of a log held against the derivatives of its positions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import mujoco
import numpy as np

from ves_twin.machines.mjcf.draft.changes import DEGREE, TURN
from ves_twin.machines.mjcf.draft.log_columns import LogColumns
from ves_twin.machines.mjcf.draft.match import Match
from ves_twin.machines.mjcf.draft.spots import Quantity
from ves_twin.machines.mjcf.parts.predecessor import predecessor

FOLLOWS = 0.5
"""Correlation below which a speed is none of its position."""

SAME, ITSELF = 0.2, 0.05
"""Shares by which a factor may be off to be taken for a unit's, or for one."""

EXACT = 1e-3
"""The same of a correlation that no friction has: an arm's wrist had 0.961."""

COPY = 1e-6
"""The same of a column that is there twice, to the digits it is written with."""

DECADE, APART = 0.1, 0.2
"""Weight of a decade between a speed and the rate of its position, and of no likeness at all."""

UNITS = {
    "rad/s": {"deg/s": 1.0 / DEGREE, "rpm": 30.0 / np.pi, "turn/s": 1.0 / TURN},
    "m/s": {"mm/s": 1e3},
}
"""Unit of a speed -> others, and how many of them make one."""


def rated(
    log: LogColumns, found: list[Match], corner: float, model: mujoco.MjModel
) -> tuple[list[Match], list[str]]:
    """Speeds with the signs and units that the rates of their positions tell, and words for them.

    Args:
        log: whose columns they are.
        found: columns as they are meant.
        corner: of the low-pass [Hz].
        model: of which joints may turn about one axis.

    Returns:
        The columns, without speeds that follow no position; a sentence for each change.
    """
    said, result, slopes = [], [], list[float]()
    positions = _of(found, Quantity.POSITION)
    speeds = _of(found, Quantity.SPEED)
    for match in found:
        own = positions.get(match.spot.name)
        if match.spot.quantity is not Quantity.SPEED or own is None:
            result.append(match)
            continue
        before = predecessor(model, match.spot.name, speeds) if own.alone else None
        if before is not None and match.unit == speeds[before[0]].unit:
            match = match.less(speeds[before[0]], before[1])
        alike, slope = ratio(log, match, own, corner)
        other = ratio(log, own, match, corner)[0]
        swapped = abs(other) > max(1.0 - ITSELF, abs(alike))
        if abs(alike) < FOLLOWS or swapped:
            said.append(_words_of_none(log, match, own, alike, swapped))
            continue
        if slope < 0.0:
            match = replace(match, scale=-match.scale)
            said.append(f"{match.column} counts against {own.column}: it is turned")
        unit = _unit(match, abs(slope))
        slopes.append(abs(slope))
        if unit:
            words = f"numbers fit {own.column} as {unit}, not as {match.unit}"
            match = replace(match, unit=unit)
            said.append(f"{match.column}: {words}")
        elif abs(own.scale) != 1.0 and abs(abs(slope * own.scale) - 1.0) < SAME:
            match = replace(match, scale=match.scale * abs(own.scale))
            said.append(f"{match.column}: numbers fit {own.column} as those of the motor, too")
        elif not 0.6 < abs(slope) < 1.6:
            rate = f"{abs(slope):.3g} times the rate of {own.column}"
            said.append(f"{match.column} is {rate}: another unit, or the clock's?")
        result.append(match)
    return result, [*said, *_clock(slopes), *_swapped(log, found, corner)]


def differs(log: LogColumns, found: Sequence[Match], corner: float) -> float:
    """What speeds have against positions as they are meant: decades between them, no likeness."""
    positions, total = _of(found, Quantity.POSITION), 0.0
    for joint, match in _of(found, Quantity.SPEED).items():
        if joint not in positions:
            continue
        alike, slope = ratio(log, match, positions[joint], corner)
        factors = [1.0] if match.told else [1.0, *UNITS.get(match.spot.unit, {}).values()]
        decades = min(abs(float(np.log10(max(abs(slope), 1e-6) / f))) for f in factors)
        likely = abs(alike) >= FOLLOWS
        total += APART * (1.0 - abs(alike)) + DECADE * min(decades, 3.0) * likely
    return total


def ratio(log: LogColumns, speed: Match, position: Match, corner: float) -> tuple[float, float]:
    """Correlation of a column with the rate of a position, and its slope on it, both in SI."""
    v = speed.factor * log.smooth(speed.column, corner)
    q = position.factor * log.smooth(position.column, corner)
    rate = np.gradient(q, log.period)
    power = float(rate @ rate)
    if not power or not np.ptp(v):
        return 0.0, 0.0
    return float(np.corrcoef(v, rate)[0, 1]), float(v @ rate) / power


def _words_of_none(log: LogColumns, match: Match, own: Match, alike: float, swapped: bool) -> str:
    """What is said of a speed that is none of its position."""
    if swapped:
        return f"{own.column} is the rate of {match.column}: are they swapped?"
    same = np.corrcoef(log.column(match.column), log.column(own.column))[0, 1]
    if abs(same) > 1.0 - COPY:
        return f"{match.column} is {own.column} once more: left out"
    return f"{match.column} does not follow {own.column} ({alike:+.2f}): left out"


def _of(found: Sequence[Match], quantity: Quantity) -> dict[str, Match]:
    return {m.spot.name: m for m in found if m.spot.quantity is quantity}


def _unit(match: Match, slope: float) -> str:
    """Another unit whose factor the slope is; empty if it is none's, or its own."""
    units = {u: f for u, f in UNITS.get(match.spot.unit, {}).items() if u != match.unit}
    return next((u for u, f in units.items() if abs(slope / f - 1.0) < SAME), "")


def _clock(slopes: Sequence[float]) -> list[str]:
    """That all speeds are the same factor off, where it is no unit's."""
    if len(slopes) < 2 or np.ptp(slopes) > ITSELF * np.mean(slopes):
        return []
    factor = float(np.mean(slopes))
    if 1.0 / (1.0 + SAME) < factor < 1.0 + SAME or not 0.05 < factor < 20.0:
        return []
    return [f"all speeds are {factor:.3g} times the rate of their positions: is the clock right?"]


def _swapped(log: LogColumns, found: Sequence[Match], corner: float) -> list[str]:
    """That an effort is the rate of its joint's position.

    Where nothing is taken for that rate, viscous friction of 1 in SI looks like it: only what is
    the rate to a thousandth is told then.
    """
    positions, said = _of(found, Quantity.POSITION), []
    speeds = _of(found, Quantity.SPEED)
    for match in found:
        own = positions.get(match.spot.joint) if match.spot.joint else None
        if match.spot.quantity is not Quantity.EFFORT or own is None:
            continue
        alike, slope = ratio(log, match, own, corner)
        off = ITSELF if match.spot.joint in speeds else EXACT
        if abs(alike) > 1.0 - off and abs(abs(slope) - 1.0) < ITSELF:
            said.append(
                f"{match.column} is the rate of {own.column}: are effort and speed swapped?"
            )
    return said
