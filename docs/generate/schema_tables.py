"""schema_tables: a JSON schema as tables, one for each kind of table in the file."""

from __future__ import annotations

import json
from typing import Any

_BOUNDS = {
    "ge": ">=",
    "gt": ">",
    "le": "<=",
    "lt": "<",
    "minimum": ">=",
    "exclusiveMinimum": ">",
    "maximum": "<=",
    "exclusiveMaximum": "<",
}


def schema_tables(schema: dict[str, Any], level: int = 2, title: bool = True) -> str:
    """The file's own keys first, then each kind of table that it holds.

    Args:
        schema: as pydantic makes it.
        level: of the headings.
        title: whether the first table has one; without, names of tables are no links.
    """
    schema = _with_choices(schema, schema.get("$defs", {}), title)
    parts = [_table(schema, level, schema["title"] if title else None)]
    kinds = schema.get("$defs", {}).items()
    parts += [_table(part, level, name) for name, part in kinds if "properties" in part]
    return "\n".join(parts)


def _with_choices(node: Any, kinds: dict[str, Any], linked: bool) -> Any:
    """The schema with each reference to a list of choices replaced by the list."""
    if isinstance(node, list):
        return [_with_choices(child, kinds, linked) for child in node]
    if not isinstance(node, dict):
        return node
    name = str(node.get("$ref", "")).split("/")[-1]
    if "enum" in kinds.get(name, ()):
        return {**node, "$ref": None, "enum": kinds[name]["enum"]}
    return {key: _with_choices(child, kinds, linked) for key, child in node.items()} | (
        {"linked": linked} if name else {}
    )


def _table(part: dict[str, Any], level: int, name: str | None) -> str:
    lines = [f"{'#' * level} {name}", ""] if name else []
    lines += [_text(part.get("description", "")), ""]
    lines += ["| key | value | unit | default | bounds |", "|---|---|---|---|---|"]
    required = part.get("required", ())
    for key, value in part["properties"].items():
        default = "**required**" if key in required else _default(value)
        cells = (f"`{key}`", _kind(value), value.get("unit", ""), default, _bounds(value))
        lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return "\n".join([*lines, ""])


def _text(docstring: str) -> str:
    """A docstring as Markdown; its section heads become words of their own."""
    lines = [line.strip() for line in docstring.splitlines()]
    shown = []
    inside = False
    for line in lines:
        if line in ("Attributes:", "Raises:"):
            inside = line == "Attributes:"
            shown += ["", ""] if inside else []
            if not inside:
                break
        elif inside and line:
            first = line.split(":")[0]
            starts = ":" in line and all(word.isidentifier() for word in first.split(", "))
            shown.append(f"- {line}" if starts else f"  {line}")
        else:
            shown.append(line)
    return "\n".join(shown)


def _kind(value: dict[str, Any]) -> str:
    if value.get("$ref"):
        name = value["$ref"].split("/")[-1]
        return f"[{name}](#{name.lower()})" if value.get("linked", True) else name
    if "unit" in value:
        return f"{value['minItems']} numbers" if "minItems" in value else "number"
    if "enum" in value:
        return ", ".join(f"`{choice}`" for choice in value["enum"])
    if "const" in value:
        return f"`{json.dumps(value['const'])}`"
    if "examples" in value:
        return ", ".join(f"`{name}`" for name in value["examples"])
    for word in ("anyOf", "oneOf"):
        if word in value:
            return " or ".join(
                dict.fromkeys(_kind(v) for v in value[word] if v != {"type": "null"})
            )
    if value.get("type") == "array":
        return _array(value)
    if value.get("type") == "object":
        inner = value.get("additionalProperties")
        return f"table of {_kind(inner)}" if isinstance(inner, dict) else "table"
    words = {"string": "text", "integer": "whole number", "boolean": "true, false"}
    return words.get(value.get("type", ""), value.get("type", "anything"))


def _array(value: dict[str, Any]) -> str:
    if "prefixItems" in value:
        kinds = [_kind(item) for item in value["prefixItems"]]
        return f"[{', '.join(kinds)}]"
    low, high = value.get("minItems"), value.get("maxItems")
    count = f"{low} of " if low and low == high else f"at least {low} of " if low else "list of "
    return count + _kind(value.get("items", {}))


def _default(value: dict[str, Any]) -> str:
    if value.get("default") is None:
        return ""
    text = json.dumps(value["default"])
    return f"`{text}`" if len(text) < 60 else "its own defaults"


def _bounds(value: dict[str, Any]) -> str:
    """Bounds of a number, or of the number among the alternatives."""
    found = [value, *value.get("anyOf", ())]
    return ", ".join(
        f"{sign} {part[word]:g}" for part in found for word, sign in _BOUNDS.items() if word in part
    )
