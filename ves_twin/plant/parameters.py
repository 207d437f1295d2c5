"""Parameters: numbers with unit, sd, grade and source, read from models/*.toml."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from pathlib import Path

import numpy as np

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.read_only import ReadOnly
from ves_twin.core.toml_file import check_schema, read_toml
from ves_twin.core.types import FloatArray
from ves_twin.core.units import check_unit, to_si, unit_tail

SCHEMA = 1
"""Version of the plant file format."""

LEGS = 6
"""Legs of the platform."""

HEAD_KEYS = frozenset(
    {"schema", "name", "base", "hydraulic_model", "fidelity", "parameters", "effects", "laws"}
)
"""Keys of a plant file beside its parameters."""

_KEYS = {"value", "unit", "sd", "low", "high", "grade", "source", "each"}


class Grade(StrEnum):
    """How a number came about; an invented one is never shown as a measured one."""

    THESIS = "thesis"
    DERIVED = "derived"
    CALIBRATED = "calibrated"
    ASSUMED = "assumed"


@dataclass(frozen=True)
class Parameter(ReadOnly):
    """One number or array of the rig.

    Attributes:
        name: dotted name, for instance "leg.rod_mass".
        value: value in `unit`; a 0-d, 1-d or 2-d array.
        unit: SI unit; for a wrench the units of force and moment.
        sd: what commissioning leaves open, one sigma, same shape or scalar.
        low: smallest value allowed.
        high: largest value allowed.
        grade: how the number came about.
        source: where it comes from.
        per_leg: whether it has six values, a single number standing for all legs.
    """

    name: str
    value: FloatArray
    unit: str
    sd: FloatArray
    low: float
    high: float
    grade: Grade
    source: str
    per_leg: bool = False

    def with_value(self, value: object) -> Parameter:
        """The same parameter with another value.

        Args:
            value: a number, a text with a unit, or nested lists of the same shape; a single
                number for a parameter of each leg is that of all legs.

        Raises:
            InvalidInputError: another shape or unit, not finite, or out of bounds.
        """
        array = _numbers(value, self.unit, self.name)
        if self.per_leg and array.shape == ():
            array = np.full(LEGS, array)
        if array.shape != self.value.shape:
            shape = f"shape {self.value.shape}" if self.value.shape else "a single number"
            raise InvalidInputError(self.name, value, shape)
        return replace(self, value=array).checked(value)

    def checked(self, came: object) -> Parameter:
        """This parameter, if its value is within bounds; `came` is what a message shows."""
        if np.any(self.value < self.low) or np.any(self.value > self.high):
            bounds = f"a value of at least {self.low:g}{unit_tail(self.unit)}"
            if np.isfinite(self.high):
                bounds += f" and at most {self.high:g}"
            raise InvalidInputError(self.name, came, bounds)
        if self.unit == "1" and np.any(self.value != np.rint(self.value)):
            raise InvalidInputError(self.name, came, "a whole number")
        return self


@dataclass(frozen=True)
class ParameterTable(Mapping[str, Parameter]):
    """All parameters of a rig by dotted name."""

    entries: Mapping[str, Parameter]

    def __getitem__(self, name: str) -> Parameter:
        try:
            return self.entries[name]
        except KeyError:
            raise UnknownNameError("parameter", name, self.entries) from None

    def __contains__(self, name: object) -> bool:
        return name in self.entries

    def __iter__(self) -> Iterator[str]:
        return iter(self.entries)

    def __len__(self) -> int:
        return len(self.entries)

    def number(self, name: str) -> float:
        """Value of a scalar parameter in SI, or the value that all legs share.

        Raises:
            InvalidInputError: legs that differ, where one number must stand for them.
        """
        value = self[name].value
        if self[name].per_leg:
            if np.any(value != value[0]):
                raise InvalidInputError(name, value.tolist(), "the same value for all legs here")
            return float(value[0])
        return float(value)

    def array(self, name: str) -> FloatArray:
        """Value of an array parameter in SI, a fresh copy."""
        return np.array(self[name].value)

    def with_values(self, values: Mapping[str, object]) -> ParameterTable:
        """A table in which some parameters have other values.

        Raises:
            UnknownNameError: no such parameter.
            InvalidInputError: wrong shape or unit, not finite, or out of bounds.
        """
        changed = {name: self[name].with_value(value) for name, value in values.items()}
        return ParameterTable({**self.entries, **changed})

    def differences(self, other: ParameterTable) -> dict[str, tuple[FloatArray, FloatArray]]:
        """Parameters whose values differ: name -> (value here, value there)."""
        return {
            name: (self[name].value, other[name].value)
            for name in self
            if name in other and not np.array_equal(self[name].value, other[name].value)
        }


def read_plant_file(path: Path) -> dict[str, object]:
    """Content of a plant file, checked for its schema version.

    Raises:
        FileAccessError: not readable.
        InvalidInputError: not TOML.
        VersionError: written for another version of the format.
    """
    content, _ = read_toml("plant file", path)
    check_schema(content, path, SCHEMA)
    return content


def parse_parameters(content: Mapping[str, object], path: Path) -> ParameterTable:
    """The table of a plant file's content: every table with a `value` is a parameter."""
    entries: dict[str, Parameter] = {}
    _collect("", content, entries, path)
    return ParameterTable(entries)


def _collect(
    prefix: str, node: Mapping[str, object], entries: dict[str, Parameter], path: Path
) -> None:
    for key, child in node.items():
        name = f"{prefix}{key}"
        if not isinstance(child, Mapping):
            if prefix or key not in HEAD_KEYS:
                raise InvalidInputError(f"{path}: {name}", child, "a table with value and unit")
        elif "value" in child:
            entries[name] = _parameter(name, child)
        elif key not in {"parameters", "effects"} or prefix:
            _collect(f"{name}.", child, entries, path)


def _parameter(name: str, entry: Mapping[str, object]) -> Parameter:
    for key in entry:
        if key not in _KEYS:
            raise UnknownNameError(f"key of {name}", key, _KEYS)
    for key in ("unit", "grade", "source"):
        if not isinstance(entry.get(key), str) or not entry[key]:
            raise InvalidInputError(f"{name}.{key}", entry.get(key), "a text")
    if entry["grade"] not in set(Grade):
        raise UnknownNameError(f"grade of {name}", str(entry["grade"]), set(Grade))
    unit = str(entry["unit"])
    for part in unit.split(", "):
        check_unit(part, f"{name}.unit")
    per_leg = _is_per_leg(name, entry)
    value = _numbers(entry["value"], unit, name)
    if per_leg and value.shape == ():
        value = np.full(LEGS, value)
    if per_leg and value.shape != (LEGS,):
        raise InvalidInputError(name, entry["value"], f"one number, or one for each of {LEGS} legs")
    sd = _numbers(entry.get("sd"), unit, f"{name}.sd")
    if sd.shape not in {(), value.shape[-1:], value.shape} or np.any(sd < 0):
        raise InvalidInputError(f"{name}.sd", entry["sd"], "one number >= 0, or one for each value")
    return Parameter(
        name=name,
        value=value,
        unit=unit,
        sd=np.broadcast_to(sd, value.shape),
        low=_bound(entry, "low", -np.inf, unit, name),
        high=_bound(entry, "high", np.inf, unit, name),
        grade=Grade(str(entry["grade"])),
        source=str(entry["source"]),
        per_leg=per_leg,
    ).checked(entry["value"])


def _is_per_leg(name: str, entry: Mapping[str, object]) -> bool:
    if entry.get("each", "leg") != "leg":
        raise InvalidInputError(f"{name}.each", entry["each"], '"leg", or no such key')
    return "each" in entry


def _bound(entry: Mapping[str, object], key: str, default: float, unit: str, name: str) -> float:
    if key not in entry:
        return default
    return to_si(entry[key], unit.split(", ")[0], f"{name}.{key}")


def _numbers(value: object, unit: str, what: str) -> FloatArray:
    """Nested lists of numbers or texts with units as an array in SI.

    A unit such as "N, N*m" is that of the first half of the values and that of the second.
    """
    if isinstance(value, np.ndarray):
        value = value.tolist()
    units = unit.split(", ")
    if isinstance(value, list | tuple):
        share = max(1, len(value) // len(units))
        rows = [
            _numbers(item, units[min(i // share, len(units) - 1)], f"{what}[{i + 1}]")
            for i, item in enumerate(value)
        ]
        if not rows or len({row.shape for row in rows}) != 1:
            raise InvalidInputError(what, value, "numbers of one shape")
        return np.array(rows)
    return np.array(to_si(value, units[0], what))
