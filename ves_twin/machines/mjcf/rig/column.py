"""Column: a signal of a log, and what makes it SI."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from ves_twin.core.units import SI_UNITS, to_unit
from ves_twin.scenario.fields import Part, named

LAB_UNITS = {
    **dict.fromkeys(("mm", "cm", "um", "in"), "m"),
    **dict.fromkeys(("deg", "mrad", "turn"), "rad"),
    **dict.fromkeys(("mm/s", "cm/s"), "m/s"),
    **dict.fromkeys(("deg/s", "mrad/s", "turn/s", "rpm"), "rad/s"),
    **dict.fromkeys(("kN", "mN"), "N"),
    **dict.fromkeys(("mN*m", "cN*m", "kN*m"), "N*m"),
    **dict.fromkeys(("kPa", "MPa", "bar", "psi"), "Pa"),
}
"""Other units that a signal may have, which are converted -> SI unit."""

Unit = Annotated[str, named("unit", sorted({*SI_UNITS, *LAB_UNITS}))]
Number = float | str
"""A number in SI, or a text with a unit; the place that reads it knows which."""


class Column(Part):
    """A signal: columns of the file, and what makes them SI.

    value = scale * column + offset, in the unit, then, for vectors given in the world, turned into
    the frame of a signal that holds a quaternion x, y, z, w (sensor to world). A column may be a
    formula of columns. Where the signal says `joint`, `actuator` or `sensor`, it needs no entry in
    `compare` and none in `drive`: that mode and place decide whether it is fed in or compared.
    `repeats`: rows that a reading stands for until the next one comes; those between are taken
    straight. `axis`: the one number of three that is measured of the sensor, in its own frame.
    """

    columns: tuple[str, ...] = Field(min_length=1)
    unit: Unit
    scale: float = 1.0
    offset: float = 0.0
    repeats: int = Field(default=1, ge=1)
    noise: Number | tuple[Number, ...] = 0.0
    into: str = ""
    joint: str = ""
    of: Literal["position", "speed"] = "position"
    actuator: str = ""
    sensor: str = ""
    axis: Literal["", "x", "y", "z"] = ""
    source: str = ""

    @model_validator(mode="before")
    @classmethod
    def _in_si(cls, content: object) -> object:
        """With the unit converted, so that all behind has SI alone; noise is told in SI or text."""
        if not isinstance(content, dict):
            return content
        given, numbers = content.get("unit"), [content.get(k, 0.0) for k in ("scale", "offset")]
        if not isinstance(given, str) or given not in LAB_UNITS or not all(map(_number, numbers)):
            return content
        si_unit = LAB_UNITS[given]
        factor, zero = to_unit(given, si_unit, "unit")
        scale, offset = content.get("scale", 1.0), content.get("offset", 0.0)
        si = {"unit": si_unit, "scale": factor * scale, "offset": factor * offset + zero}
        return {**content, **si}


def _number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
