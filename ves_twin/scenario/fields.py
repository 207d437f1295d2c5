"""fields: the types that scenario and procedure files share: frozen tables, numbers with units."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict

from ves_twin.errors import InvalidInputError, UnknownNameError, shown
from ves_twin.units import to_si

TURNS = 4.0 * math.pi
"""Largest joint angle that makes sense [rad]."""


@dataclass(frozen=True)
class InUnit(BeforeValidator):
    """A validator that knows the SI unit of what it lets through."""

    unit: str = "1"


def si(unit: str) -> InUnit:
    """A number in SI, or a text with a unit that converts to `unit`."""

    def convert(value: object) -> float:
        try:
            return to_si(value, unit, "value")
        except InvalidInputError as error:
            raise ValueError(str(error)) from None

    return InUnit(convert, unit=unit)


def _pose(value: object) -> tuple[float, ...]:
    return _row(value, ("m", "m", "m", "rad", "rad", "rad"))


def _joints(value: object) -> tuple[float, ...]:
    angles = _row(value, ("rad", "rad", "rad"))
    if any(abs(angle) > TURNS for angle in angles):
        raise ValueError(f"got {shown(value)}, expected angles within two turns")
    return angles


def _row(value: object, units: tuple[str, ...]) -> tuple[float, ...]:
    if not isinstance(value, list | tuple) or len(value) != len(units):
        raise ValueError(f"got {shown(value)}, expected {len(units)} numbers in {', '.join(units)}")
    try:
        pairs = enumerate(zip(value, units, strict=True), 1)
        return tuple(to_si(v, unit, f"[{i}]") for i, (v, unit) in pairs)
    except InvalidInputError as error:
        raise ValueError(str(error)) from None


def named(kind: str, known: Any) -> BeforeValidator:
    """A name out of `known`; anything else is answered with the nearest one."""

    def check(value: object) -> object:
        if not isinstance(value, str) or value not in known:
            raise ValueError(str(UnknownNameError(kind, str(value), known)))
        return value

    return BeforeValidator(check)


Seconds = Annotated[float, si("s")]
Hertz = Annotated[float, si("Hz")]
PerSecond = Annotated[float, si("1/s")]
Metres = Annotated[float, si("m")]
Pose = Annotated[tuple[float, ...], InUnit(_pose, unit="m, rad")]
Joints = Annotated[tuple[float, ...], InUnit(_joints, unit="rad")]
ZERO_POSE = (0.0,) * 6
ZERO_JOINTS = (0.0,) * 3


class Part(BaseModel):
    """A table of the file: frozen, unknown keys refused."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)
