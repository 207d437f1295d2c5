"""key_value: what a key of a scenario came out as, in SI, and its unit."""

from __future__ import annotations

from typing import get_args

from pydantic import BaseModel

from ves_twin.core.errors import InvalidInputError
from ves_twin.effects.registry import EFFECTS, parse_effects
from ves_twin.plant.plant import Plant
from ves_twin.scenario.fields import InUnit
from ves_twin.scenario.schema import Scenario

Value = bool | int | float | str | list[float] | None
"""What a cell of a table can hold."""


def key_value(scenario: Scenario, world: Plant, key: str) -> tuple[Value, str]:
    """Value and unit of a dotted key after validation.

    Args:
        scenario: the validated scenario.
        world: its plant, with the scenario's parameters.
        key: for instance "legs.gain", "parameters.leg.rod_mass",
            "effects.valve_null.leg.3.null".

    Returns:
        The value in SI, a table or list of tables as text; and its unit, "" where it has none.
        A unit "m, rad" is that of the first half of a row and that of the second.

    Raises:
        InvalidInputError: a key that names no value, such as a whole table of effects.
    """
    table, _, name = key.partition(".")
    if table == "parameters":
        parameter = world.parameters[name]
        value = parameter.value.tolist()
        return (value if not isinstance(value, list) else _flat(value)), parameter.unit
    if table == "effects":
        return _of_effect(scenario, name)
    return _of_field(scenario, key)


def _of_effect(scenario: Scenario, name: str) -> tuple[Value, str]:
    kind, _, rest = name.partition(".")
    kind = EFFECTS[kind].kind if kind in EFFECTS else kind
    for effect in parse_effects(scenario.effects):
        for magnitude in effect.magnitudes_of(effect.target):
            if f"{kind}.{rest}" == f"{effect.kind}.{effect.target}.{magnitude.name}":
                return effect.values[magnitude.name], magnitude.unit
    raise InvalidInputError(
        "--vary", f"effects.{name}", "effects.KIND.TARGET.MAGNITUDE, as in valve_null.leg.3.null"
    )


def _of_field(scenario: Scenario, key: str) -> tuple[Value, str]:
    node: object = scenario
    field = None
    for step in key.split("."):
        if not isinstance(node, BaseModel):
            raise InvalidInputError("--vary", key, "a key of a table")
        field = type(node).model_fields[step]
        node = getattr(node, step)
    unit = "" if field is None else _unit([*field.metadata, field.annotation])
    if isinstance(node, BaseModel):
        return node.model_dump_json(), ""
    if isinstance(node, tuple):
        if all(isinstance(item, int | float) for item in node):
            return [float(item) for item in node], unit
        return str([getattr(item, "model_dump_json", item.__str__)() for item in node]), ""
    if node is None or isinstance(node, bool | int | float | str):
        return (str(node) if isinstance(node, str) else node), unit
    return str(node), ""


def _unit(parts: list[object]) -> str:
    """The first unit in the metadata of a field or inside its annotation."""
    for part in parts:
        if isinstance(part, InUnit):
            return part.unit
        inner = _unit(list(get_args(part)))
        if inner:
            return inner
    return ""


def _flat(values: list[object]) -> list[float]:
    """Rows of rows as one row."""
    result: list[float] = []
    for value in values:
        result += _flat(value) if isinstance(value, list) else [float(str(value))]
    return result
