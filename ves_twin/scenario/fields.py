"""fields: the types that scenario and procedure files share: frozen tables, numbers with units."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Annotated, Any

from pydantic import BeforeValidator, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema

from ves_twin.core.errors import InvalidInputError, UnknownNameError, shown
from ves_twin.core.part import Part as Part
from ves_twin.core.units import to_si

TURNS = 4.0 * math.pi
"""Largest joint angle that makes sense [rad]."""


@dataclass(frozen=True)
class InUnit(BeforeValidator):
    """A validator that knows the SI unit, and for a row the length, of what it lets through."""

    unit: str = "1"
    length: int | None = None

    def __get_pydantic_json_schema__(
        self, core: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        """The schema with the unit in it, and texts with a unit allowed wherever numbers are."""
        found = handler(core)
        if self.length is None:
            return {"anyOf": [found, {"type": "string"}], "unit": self.unit}
        either = {"anyOf": [{"type": "number"}, {"type": "string"}]}
        size = {"minItems": self.length, "maxItems": self.length}
        return {"type": "array", "items": either, **size, "unit": self.unit}


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


@dataclass(frozen=True)
class OneOf(BeforeValidator):
    """A validator that knows the names that it lets through."""

    known: Any = field(default=(), hash=False, compare=False)

    def __get_pydantic_json_schema__(
        self, core: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        """The schema with the names in it; examples, since installed packages may add some."""
        found = handler(core)
        return {**found, "examples": list(self.known)} if found.get("type") == "string" else found


def named(kind: str, known: Any) -> BeforeValidator:
    """A name out of `known`; anything else is answered with the nearest one."""

    def check(value: object) -> object:
        if not isinstance(value, str) or value not in known:
            raise ValueError(str(UnknownNameError(kind, str(value), known)))
        return value

    return OneOf(check, known=known)


Seconds = Annotated[float, si("s")]
Hertz = Annotated[float, si("Hz")]
PerSecond = Annotated[float, si("1/s")]
Metres = Annotated[float, si("m")]
Pose = Annotated[tuple[float, ...], InUnit(_pose, unit="m, rad", length=6)]
Joints = Annotated[tuple[float, ...], InUnit(_joints, unit="rad", length=3)]
ZERO_POSE = (0.0,) * 6
ZERO_JOINTS = (0.0,) * 3
