"""likeness: how well a column's name and unit fit a spot of a model, and why."""

from __future__ import annotations

import re
from dataclasses import dataclass

from ves_twin.data.unit_names import bare_name, spelled
from ves_twin.machines.mjcf.description import LAB_UNITS
from ves_twin.machines.mjcf.draft.spots import Quantity, Spot, words_of

KIND_WORDS = {
    Quantity.POSITION: frozenset(
        "q qm qg pos position angle angles ang theta th phi psi alpha x y z s stroke disp"
        " displacement travel encoder enc length rot rotation".split()
    ),
    Quantity.SPEED: frozenset(
        "dq qd qdot dqdt vel velocity speed rate omega w v dx dy xd xdot thetadot gyro qv".split()
    ),
    Quantity.EFFORT: frozenset(
        "tau torque trq tq force f fx u effort load moment current i cur amp volt voltage pwm"
        " drive motor control ctrl command input".split()
    ),
}
"""Words that laboratories use for a quantity; a column's name is cut at digits and bars."""

SETPOINT = frozenset(
    "ref reference set setpoint des desired target goal demand nominal cmd command commanded".split()
)
MEASURED = frozenset("meas measured act actual fb feedback".split())

ELECTRICAL = frozenset({"V", "mV", "A", "mA", "%", "counts", "W", "1"})
"""Units of what drives an actuator when it is no effort: a constant stands between."""

EFFORTS = frozenset({"N", "N*m", "kN", "mN*m", "rad", "m", "rad/s", "m/s"})
"""Units that the command of an actuator with a gain or a servo may have."""

VOLTS = re.compile(r"V[_.]?\d*")
"""Names that mean volts of whatever, not a speed."""

OTHER = frozenset({"ddq", "qdd", "acc", "accel", "acceleration", "temp", "temperature"})
"""Words of what neither joints nor motors have."""

ARTICLE = {q: f"{'an' if q.value[0] == 'e' else 'a'} {q.value}" for q in Quantity}

UNIT, KIND, WORD, NUMBER, ONLY = 2.0, 2.0, 2.0, 2.0, 1.0
"""Weight of each piece of evidence: any two of them are worth a match."""

WRONG_NUMBER, WRONG_KIND, WISH = -3.0, -2.0, -0.5
"""Weight against: another number, a word of another quantity, what was asked for, not measured."""

ENOUGH = 2.5
"""Likeness from which a column is matched: two pieces of evidence, or one and no rival spot."""


@dataclass(frozen=True)
class Likeness:
    """How well a column fits a spot.

    Attributes:
        score: sum of the weights of the evidence.
        reasons: what speaks for it.
    """

    score: float
    reasons: tuple[str, ...]


def likeness(column: str, unit: str, spot: Spot, only: bool, zero: bool) -> Likeness | None:
    """The evidence of a column's name and unit for a spot; None where they rule it out.

    Args:
        column: its name.
        unit: as the log says it; empty if it does not.
        spot: of the model.
        only: no other spot of the model has this quantity and unit.
        zero: columns of this kind are numbered from 0.
    """
    words = words_of(bare_name(column))
    if VOLTS.fullmatch(bare_name(column)):
        words = tuple(w for w in words if w != "v")
    if OTHER & set(words) and spot.quantity is not Quantity.SENSOR:
        return None
    wish = bool(SETPOINT & set(words)) and not MEASURED & set(words)
    if wish and spot.quantity in (Quantity.POSITION, Quantity.SPEED):
        return None
    if not _unit_fits(spelled(unit), spot):
        return None
    score, reasons = 0.0, []
    if unit:
        score, reasons = UNIT, [f"unit {unit}"]
    named = {q for q, known in KIND_WORDS.items() if known & set(words)}
    if spot.quantity in named and not (unit and len(named) > 1):
        score += KIND
        reasons.append(f"name of {ARTICLE[spot.quantity]}")
    elif named and spot.quantity not in named and not unit:
        score += WRONG_KIND
    shared = (spot.words & set(words)) - {w for w in words if w.isdigit()}
    if spot.quantity is not Quantity.SENSOR or len(shared) > 0:
        shared = {w for w in shared if len(w) > 1 or spot.quantity is Quantity.SENSOR}
    if shared:
        score += WORD
        reasons.append(f"shares '{max(shared, key=len)}' with {spot.label}")
    numbers = [int(w) for w in words if w.isdigit()]
    if numbers and not only:
        same = numbers[-1] + int(zero) == spot.number
        score += NUMBER if same else WRONG_NUMBER
        reasons += [f"number {numbers[-1]}"] if same else []
    if only:
        score += ONLY
        reasons.append(f"the only {spot.quantity.value} of the model in {spot.unit}")
    if wish:
        score += WISH
    return Likeness(score, tuple(reasons))


def is_setpoint(column: str) -> bool:
    """Whether a column's name says that it was asked for rather than measured."""
    return bool(SETPOINT & set(words_of(bare_name(column))))


def _unit_fits(unit: str, spot: Spot) -> bool:
    """Whether a unit can be a spot's; what drives a motor may be electrical."""
    if not unit:
        return True
    if spot.quantity is Quantity.EFFORT and unit in ELECTRICAL:
        return True
    if spot.quantity is Quantity.EFFORT and spot.unit == "1":
        return unit in EFFORTS
    return LAB_UNITS.get(unit, unit) == spot.unit
