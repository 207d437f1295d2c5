"""Column: a signal of a log, and what makes it SI."""

from __future__ import annotations

from typing import Annotated, Literal, Self

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

INTEGRALS = {"rad/s": "rad", "m/s": "m"}
"""Unit of a speed -> that of its integral."""

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

    An `integrated` column is a speed, in the unit of one. The position of its joint is the integral
    of scale * column from the first row on, plus offset (rad or m): enough where efforts do not
    hang on where the joint stands (a rotor, a wheel), else as good as the offset is.
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
    integrated: bool = False
    source: str = ""

    @model_validator(mode="before")
    @classmethod
    def _in_si(cls, content: object) -> object:
        """With the unit converted, so that all behind has SI alone; noise is told in SI or text."""
        if not isinstance(content, dict):
            return content
        given, numbers = content.get("unit"), [content.get(k, 0.0) for k in ("scale", "offset")]
        if isinstance(given, str) and given in LAB_UNITS and all(map(_number, numbers)):
            factor, zero = to_unit(given, LAB_UNITS[given], "unit")
            scale, offset = content.get("scale", 1.0), content.get("offset", 0.0)
            whole = content.get("integrated") is True  # an offset is one of the integral then
            shift = offset if whole else factor * offset + zero
            si = {"unit": LAB_UNITS[given], "scale": factor * scale, "offset": shift}
            content = {**content, **si}
        return _of_integral(content) if content.get("integrated") is True else content

    @model_validator(mode="after")
    def _of_one_joint(self) -> Self:
        if self.integrated and (not self.joint or self.of == "speed" or len(self.columns) != 1):
            raise ValueError("integrated: expected one column, and the joint whose position it is")
        return self


def _of_integral(content: dict[str, object]) -> dict[str, object]:
    """With the unit of a speed's integral."""
    unit = content.get("unit")
    if unit not in INTEGRALS:
        raise ValueError(f"integrated: unit {unit!r}; expected that of a speed, as rad/s")
    return {**content, "unit": INTEGRALS[str(unit)]}


def _number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
