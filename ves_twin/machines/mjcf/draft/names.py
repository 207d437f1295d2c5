"""likeness: how well a column's name and unit fit a spot of a model, and why."""

from __future__ import annotations

import re
from collections.abc import Collection
from dataclasses import dataclass

from ves_twin.data.formats.unit_names import bare_name, spelled
from ves_twin.machines.mjcf.draft.spots import Quantity, Spot, own_number, words_of
from ves_twin.machines.mjcf.rig.column import LAB_UNITS

POSITION = (
    "q qm qg pos position angle angles ang theta th phi psi alpha x y z s stroke disp displacement"
    " travel encoder enc length rot rotation weg lage winkel"
)
SPEED = (
    "dq qd qdot dqdt vel velocity speed rate rpm omega w v dx dy xd xdot thetadot gyro qv drehzahl"
    " geschw geschwindigkeit"
)
EFFORT = (
    "tau torque trq tq force f fx u effort load moment current i iq isq cur amp volt voltage vm pwm"
    " duty pulse throttle esc drive motor control ctrl command input kraft drehmoment strom"
    " motorstrom spannung pressure druck"
)
MECHANICAL = "tau torque trq tq force effort load moment kraft drehmoment"
KIND_WORDS = {
    Quantity.POSITION: frozenset(POSITION.split()),
    Quantity.SPEED: frozenset(SPEED.split()),
    Quantity.EFFORT: frozenset(EFFORT.split()),
}
"""Words that laboratories use for a quantity, English and German; a column's name is cut at digits
and bars."""

TURNS = frozenset(
    [
        "angle",
        "angles",
        "ang",
        "theta",
        "th",
        "phi",
        "psi",
        "alpha",
        "rot",
        "rotation",
        "winkel",
        "omega",
        "thetadot",
        "rpm",
        "drehzahl",
    ]
)
SLIDES = frozenset(["stroke", "disp", "displacement", "travel", "weg"])
"""Words of what turns, and of what slides: no unit needs to say so."""

ASKED = (
    "ref reference set setpoint sp des desired target goal demand nominal cmd command commanded"
    " soll sollwert"
)
SETPOINT = frozenset(ASKED.split())
MEASURED = frozenset({"meas", "measured", "act", "actual", "fb", "feedback", "ist", "istwert"})

PLAIN_COMMANDS = frozenset(
    ["pwm", "duty", "pulse", "throttle", "esc", "ctrl", "control", "input", "u", "stellgroesse"]
)
"""Words of what a controller puts out, beside those of what it asks for."""

ELECTRICAL = frozenset({"V", "mV", "A", "mA", "%", "counts", "W", "us", "1"})
"""Microseconds are the pulses that servos and motor controllers are told by."""

PRESSURES = frozenset({"Pa", "kPa", "MPa", "bar", "psi"})
INDIRECT = ELECTRICAL | PRESSURES
"""Units of what drives an actuator when it is no effort: a constant stands between."""

EFFORTS = frozenset({"N", "N*m", "kN", "mN*m", "cN*m", "rad", "m", "rad/s", "m/s"})
"""Units that the command of an actuator with a gain or a servo may have."""

VOLTS = re.compile(r"V[_.]?\d*")
"""Names that mean volts of whatever, not a speed."""

IMPLIED = {
    **dict.fromkeys(("current", "cur", "iq", "isq", "amp", "amps", "strom", "motorstrom"), "A"),
    **dict.fromkeys(("volt", "volts", "voltage", "vm", "spannung"), "V"),
}
"""Words of an electrical quantity -> its unit, where nobody says one."""

COILS = frozenset({"q", "d"})
"""Axes of a motor's field, behind such a word, and no position: Voltage_q."""

OTHER = frozenset({"ddq", "qdd", "acc", "accel", "acceleration", "temp", "temperature"})
"""Words of what neither joints nor motors have."""

ARTICLE = {q: f"{'an' if q.value[0] == 'e' else 'a'} {q.value}" for q in Quantity}

UNIT, KIND, WORD, NUMBER, ONLY = 2.0, 2.0, 2.0, 2.0, 1.0
"""Weight of each piece of evidence: any two of them are worth a match."""

SERVED = ("1", "m", "rad")
"""Units of the commands of what is no motor."""

SORTS = frozenset({"joint", "axis", "motor", "actuator"})
"""Words of names that are of every one of a kind."""

AXES, AXIS = frozenset("xyz"), 1.0
"""Letters of axes in the names of joints, and the weight of one that is shared."""

CALLED = frozenset({Quantity.POSITION, Quantity.EFFORT})
"""Quantities that a joint's, or an actuator's, bare name means."""

PLACED = KIND_WORDS[Quantity.POSITION] - AXES
"""Words of a position; a letter alone is an axis."""

CONSTANT = 1.5
"""Weight of an electrical unit where the spot has another: a column in the spot's own unit is
nearer, and a supply's voltage is in volts, too."""

WRONG_NUMBER, WRONG_KIND, WISH = -3.0, -2.0, -0.5
"""Weight against: another number, a word of another quantity, what was asked for, not measured."""

NAMED = 2.5
"""Weight of a name that is the spot's own, of a position or an effort: enough by itself."""

OWN = 0.4
"""Weight of many shared words that are of the spot's own name, and not of the body it is on; half
of it of one. No piece of evidence by itself: it decides between spots that are else alike."""

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
    words = _words(column)
    wish = is_setpoint(column) and not MEASURED & words
    if _ruled_out(words, wish, spot) or not _unit_fits(spelled(unit), spot):
        return None
    placed = PLACED & words
    if spelled(unit) == "counts" and (placed or not KIND_WORDS[Quantity.EFFORT] & words):
        return None  # an encoder has counts, too
    foreign = spelled(unit) in INDIRECT and spot.unit not in {"1", spelled(unit)}
    evidence = [(CONSTANT if foreign else UNIT, f"unit {unit}")] if unit else []
    shared = _of_words(words, spot)
    if bare_name(column).lower() == spot.name.lower() and spot.quantity in CALLED:
        shared = [(weight, "") for weight, _ in shared] + [(NAMED, f"named as {spot.label}")]
    evidence += _of_kind(words, bool(unit), wish, spot) + shared
    numbers = [int(w) for w in words_of(bare_name(column)) if w.isdigit()]
    if numbers and not only:
        same = numbers[-1] + int(zero) == _number(words, spot)
        evidence.append((NUMBER, f"number {numbers[-1]}") if same else (WRONG_NUMBER, ""))
    if only:
        evidence.append((ONLY, f"the only {spot.quantity.value} of the model in {spot.unit}"))
    score = sum(weight for weight, _ in evidence) + (WISH if wish else 0.0)
    return Likeness(score, tuple(words for _, words in evidence if words))


def implied_unit(column: str) -> str:
    """The unit that a word of a name implies; empty if it implies none.

    `current_position` is no ampere: a word of another quantity, or of a torque, decides.
    """
    words = _words(column)
    if "rpm" in words:
        return "rpm"
    own = {word for word in words_of(bare_name(column)) if not word.isdigit()}
    numbered = any(word.isdigit() for word in words_of(bare_name(column)))
    if {"i", "q"} <= own or (own == {"i"} and numbered):  # i alone counts rows
        return "A"
    told = [IMPLIED[word] for word in sorted(words) if word in IMPLIED]
    others = KIND_WORDS[Quantity.POSITION] | KIND_WORDS[Quantity.SPEED] | set(MECHANICAL.split())
    return "" if not told or words & (others - AXES) else told[0]


def _words(column: str) -> frozenset[str]:
    words = frozenset(words_of(bare_name(column)))
    if words & {"i", *IMPLIED}:
        words -= COILS
    return words - {"v"} if VOLTS.fullmatch(bare_name(column)) else words


def _ruled_out(words: frozenset[str], wish: bool, spot: Spot) -> bool:
    """What a joint or motor has nothing of, and what was asked for where it is measured."""
    if spot.quantity is Quantity.SENSOR:
        return False
    return bool(OTHER & words) or (wish and spot.quantity is not Quantity.EFFORT)


def _of_kind(words: frozenset[str], told: bool, wish: bool, spot: Spot) -> list[tuple[float, str]]:
    """Words of a quantity; where a unit decides, a word of another one does not count against."""
    named = {quantity for quantity, known in KIND_WORDS.items() if known & words}
    if spot.quantity is Quantity.EFFORT and spot.unit in SERVED and wish:
        return [(KIND, "asked for, as the command of a servo")]
    if spot.quantity is Quantity.SENSOR and spot.unit == "rad/s" and Quantity.SPEED in named:
        return [(KIND, "name of a rate")]
    place = PLACED & words
    if spot.quantity is Quantity.SENSOR and spot.unit == "m" and place:
        return [(KIND, "name of a place")]
    other = SLIDES if spot.unit.startswith("rad") else TURNS
    if spot.quantity in (Quantity.POSITION, Quantity.SPEED) and words & other and not told:
        return [(WRONG_KIND, "")]
    if spot.quantity in named and not (told and len(named) > 1):
        return [(KIND, f"name of {ARTICLE[spot.quantity]}")]
    return [] if not named or told or spot.quantity in named else [(WRONG_KIND, "")]


def _of_words(words: frozenset[str], spot: Spot) -> list[tuple[float, str]]:
    """Words that the column shares with the spot; single letters are axes, of sensors words."""
    shared = {w for w in spot.words & words if not w.isdigit()}
    long = {w for w in shared if len(w) > 1 or spot.quantity is Quantity.SENSOR}
    found = [(WORD, f"shares '{_told_of(long, spot)}' with {spot.label}")] if long else []
    own = len(long & set(words_of(spot.name)))
    found += [(OWN * own / (own + 1.0), "")] if own else []
    axes = shared & AXES - long
    return [*found, *((AXIS, f"axis {axis}") for axis in sorted(axes))]


def _told_of(shared: set[str], spot: Spot) -> str:
    """The name of the joint where all of it is shared, else the longest of the words."""
    return (spot.joint or spot.name) if called(shared, spot) else max(sorted(shared), key=len)


def called(words: Collection[str], spot: Spot) -> bool:
    """Whether these words hold the whole name of the spot's joint, or its own where it has none."""
    own = {w for w in words_of(spot.joint or spot.name) if not w.isdigit() and len(w) > 1}
    return len(own) > 1 and own <= set(words)


def _number(words: frozenset[str], spot: Spot) -> int:
    """The one that a column of a spot has: that of its name where they share the name."""
    own = own_number(spot.name)
    shared = words & {w for w in words_of(spot.name) if not w.isdigit()} - SORTS
    return own if own is not None and shared else spot.number


def is_setpoint(column: str) -> bool:
    """Whether a column's name says that it was asked for rather than measured."""
    return bool(SETPOINT & set(words_of(bare_name(column))))


def is_command(column: str) -> bool:
    """Whether a name says that a controller put it out: nothing senses it, so it has no noise."""
    words = frozenset(words_of(bare_name(column)))
    sensed = words & {*MEASURED, *IMPLIED, *MECHANICAL.split()}
    asked = bool(words & SETPOINT) and not words & MEASURED
    return asked or (bool(words & PLAIN_COMMANDS) and not sensed)


def is_effort(column: str, unit: str) -> bool:
    """Whether a column looks like what drives a machine, by its unit or a word of its name.

    Args:
        column: its name.
        unit: as the log or the name says it; empty if neither does.
    """
    told = LAB_UNITS.get(spelled(unit), spelled(unit)) in ("N", "N*m", "A", "V", "mA", "mV")
    return told or bool(KIND_WORDS[Quantity.EFFORT] & _words(column))


def _unit_fits(unit: str, spot: Spot) -> bool:
    """Whether a unit can be a spot's; what drives a motor may be electrical."""
    if not unit:
        return True
    if (
        spot.quantity is Quantity.EFFORT
        and unit in PRESSURES
        and "N" not in (spot.unit, spot.exerts)
    ):
        return False  # of a hinge: an area makes no torque
    if spot.quantity is Quantity.EFFORT and unit in INDIRECT:
        return spot.unit not in ("m", "rad")
    if spot.quantity is Quantity.EFFORT and spot.unit == "1":
        other = {"N": "N*m", "N*m": "N"}.get(spot.exerts)
        return unit in EFFORTS and LAB_UNITS.get(unit, unit) != other
    return LAB_UNITS.get(unit, unit) == spot.unit
