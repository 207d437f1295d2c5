"""Units: the edge where a text such as "180 deg" becomes an SI number."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import TYPE_CHECKING

from ves_twin.errors import InvalidInputError

if TYPE_CHECKING:
    from pint import UnitRegistry


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
    number = _parse(value, unit, what) if isinstance(value, str) else float(value)
    if not math.isfinite(number):
        raise InvalidInputError(what, value, f"a finite number in {unit}")
    return number


def _parse(text: str, unit: str, what: str) -> float:
    import pint

    try:
        quantity = _registry().Quantity(text)
        if quantity.unitless:
            return float(quantity.magnitude)
        return float(quantity.to(unit).magnitude)
    except pint.DimensionalityError:
        raise InvalidInputError(what, text, f"a quantity in {unit}") from None
    except Exception:  # pint raises tokenizer, syntax and attribute errors alike
        raise InvalidInputError(what, text, f'a number in {unit}, or "1 {unit}"') from None
