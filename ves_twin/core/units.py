"""Units: the edge where a text such as "180 deg" becomes an SI number."""

from __future__ import annotations

import math
import re
from functools import lru_cache
from typing import TYPE_CHECKING

from ves_twin.core.errors import InvalidInputError, UnknownNameError

if TYPE_CHECKING:
    from pint import UnitRegistry


SI_UNITS = frozenset(
    (
        *("1", "m", "rad", "s", "Hz", "kg", "N", "Pa", "m/s", "rad/s", "m/s^2", "1/s", "N/m"),
        *("N*m", "N*s/m", "N*m/rad", "N*m/rad/s", "N*m*s/rad", "kg*m^2", "N/s", "N*m/s"),
        *("N*s^2/m^2", "N*m*s^2/rad^2", "N/m^3", "N*m/rad^3", "m/N", "rad/(N*m)"),
        *("m^3", "m^3/s", "m^3/Pa", "m^3/s/Pa", "Pa*s/m^3", "dimensionless"),
    )
)
"""Units that numbers have inside; files may give others, which are converted. "1" counts whole
things, "dimensionless" is a share."""


PLAIN = frozenset({"1", "", "dimensionless"})
"""Units that nobody writes behind a number."""


def unit_tail(unit: str) -> str:
    """A unit as it stands behind a number: with a space before it, nothing where there is none."""
    return "" if unit in PLAIN else f" {unit}"


def check_unit(unit: str, what: str) -> None:
    """Raise UnknownNameError unless a unit is one that numbers have inside."""
    if unit not in SI_UNITS:
        raise UnknownNameError(f"unit in {what}", unit, SI_UNITS)


FREQUENT = {
    ("deg", "rad"): math.pi / 180.0,
    ("mrad", "rad"): 1e-3,
    ("mm", "m"): 1e-3,
    ("ms", "s"): 1e-3,
}
"""Factors of the conversions that most files ask for, to the last bit those of the unit library,
whose import takes longer than all else that a file needs."""


@lru_cache(maxsize=1)
def _registry() -> UnitRegistry:
    from pint import UnitRegistry  # slow to import, and most files are plain SI

    return UnitRegistry(autoconvert_offset_to_baseunit=True)


def to_si(value: object, unit: str, what: str) -> float:
    """A number in SI from a plain number (taken as SI) or from a text with a unit.

    Args:
        value: 3.14, or a text such as "180 deg", "12 mm", "79.3 Hz".
        unit: SI unit expected, for instance "m", "rad", "N*m/rad".
        what: name of the quantity, for messages.

    Returns:
        The value in `unit`.

    Raises:
        InvalidInputError: not a number, not finite, or a unit of another dimension.
    """
    if isinstance(value, bool) or not isinstance(value, (int, float, str)):
        raise InvalidInputError(what, value, f'a number in {unit}, or a text such as "1 {unit}"')
    try:
        number = _parse(value, unit, what) if isinstance(value, str) else float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise InvalidInputError(what, value, f"a finite number in {unit}")
    return number


_QUANTITY = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*([^\d\s].*)?")
"""A number, then the rest as its unit: a text such as "12,5 mm" must not pass as 125 mm."""

_NAME = r"[A-Za-zµμ°%]+(?:(?:\^|\*\*)-?[1-4])?"
_UNIT = re.compile(rf"{_NAME}(?:\s*[*/·]\s*{_NAME}|\s+{_NAME}){{0,6}}")
"""Names with small exponents: the unit library would evaluate an expression."""

_ANGLE = re.compile(
    r"rad|deg(?![CF])|°(?![CF])|turn|rev|cycle|circle|rpm|rps|arcmin|arcsec", re.IGNORECASE
)


def _parse(text: str, unit: str, what: str) -> float:
    wrong = InvalidInputError(what, text, f'a finite quantity in {unit}, as in "1 {unit}"')
    match = _QUANTITY.fullmatch(text)
    if match is None:
        raise wrong
    number, given = float(match[1]), (match[2] or "").strip()
    if not given:
        return number
    if not _UNIT.fullmatch(given):
        raise wrong
    # angles have no dimension, so 1 Hz would pass as 1 rad/s
    if bool(_ANGLE.search(given)) != bool(_ANGLE.search(unit)):
        raise wrong
    factor = 1.0 if given == unit else FREQUENT.get((given, unit))
    if factor is not None:
        return number * factor
    try:
        return float(_registry().Quantity(number, given.replace("%", "percent")).to(unit).magnitude)
    except Exception:  # pint raises tokenizer, syntax and attribute errors alike
        raise wrong from None


def check_known(unit: str) -> str:
    """The unit, if it is one at all; raises InvalidInputError."""
    if unit in SI_UNITS:
        return unit
    wrong = InvalidInputError("unit", unit, 'a unit, as in "mm", "deg", "N*m", "A"')
    if not _UNIT.fullmatch(unit):
        raise wrong
    try:
        _registry().parse_units(unit.replace("%", "percent"))
    except Exception:  # as in _parse
        raise wrong from None
    return unit


def to_unit(given: str, unit: str, what: str) -> tuple[float, float]:
    """Factor and offset that turn numbers in one unit into another: y = factor x + offset.

    Raises:
        InvalidInputError: a unit of another dimension.
    """
    if given == unit:
        return 1.0, 0.0
    try:
        zero, one = (to_si(f"{number} {_named(given)}", unit, what) for number in (0, 1))
    except InvalidInputError:
        raise InvalidInputError(what, given, f"a unit that converts to {unit}") from None
    return one - zero, zero


def _named(unit: str) -> str:
    return "dimensionless" if unit == "1" else unit
