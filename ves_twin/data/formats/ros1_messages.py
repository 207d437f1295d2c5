"""ros1_decoder: ROS 1 messages by their definition, as data.

The usual reader of ROS 1 messages writes a Python module from the definition in the file and
imports it; here nothing that a file holds is ever run.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Callable
from dataclasses import dataclass

from ves_twin.core.errors import InvalidInputError

SCALARS = {
    "bool": "?",
    "byte": "b",
    "char": "B",
    **{"int8": "b", "int16": "h", "int32": "i", "int64": "q"},
    **{"uint8": "B", "uint16": "H", "uint32": "I", "uint64": "Q"},
    **{"float32": "f", "float64": "d"},
}
"""Type -> code of `struct`; all little-endian (wiki.ros.org/msg)."""

PAIRS = {"time": "<II", "duration": "<ii"}

_FIELD = re.compile(r"^(?P<type>[\w/]+)(?P<array>\[(?P<count>\d*)\])?\s+(?P<name>\w+)$")


@dataclass(frozen=True)
class _Field:
    name: str
    kind: str
    array: bool
    count: int | None


def ros1_decoder(name: str, text: str) -> Callable[[bytes], dict[str, object]]:
    """A function from bytes of a message to nested dictionaries.

    Args:
        name: of the message type, "package/Type".
        text: its definition, and those that it uses behind lines of "=".

    Raises:
        InvalidInputError: a definition that is none.
    """
    types = {}
    for number, part in enumerate(re.split(r"(?m)^=+\s*$", text)):
        lines = part.strip().splitlines()
        label = name
        if number and lines and lines[0].startswith("MSG:"):
            label, lines = lines[0][4:].strip(), lines[1:]
        types[label] = _fields(lines, label)

    def decode(data: bytes) -> dict[str, object]:
        value, _ = _message(name, types, data, 0, 0)
        return value

    return decode


def _fields(lines: list[str], label: str) -> list[_Field]:
    package = label.rpartition("/")[0]
    found = []
    for line in lines:
        line = line.split("#", 1)[0].strip()
        if not line or "=" in line:  # constants are no data
            continue
        match = _FIELD.match(line)
        if match is None:
            raise InvalidInputError(f"definition of {label}", line, "TYPE NAME")
        kind = match["type"]
        if kind == "Header":
            kind = "std_msgs/Header"
        elif "/" not in kind and kind not in SCALARS and kind not in {"string", *PAIRS}:
            kind = f"{package}/{kind}"
        count = int(match["count"]) if match["count"] else None
        found.append(_Field(match["name"], kind, match["array"] is not None, count))
    return found


def _message(
    name: str, types: dict[str, list[_Field]], data: bytes, at: int, depth: int
) -> tuple[dict[str, object], int]:
    if name not in types or depth > 32:
        raise InvalidInputError("type of a message", name, "one that the file defines")
    value: dict[str, object] = {}
    for field in types[name]:
        if not field.array:
            value[field.name], at = _one(field.kind, types, data, at, depth)
            continue
        count = field.count
        if count is None:
            (count,) = struct.unpack_from("<I", data, at)
            at += 4
        if field.kind in SCALARS:
            code = f"<{count}{SCALARS[field.kind]}"
            value[field.name] = struct.unpack_from(code, data, at)
            at += struct.calcsize(code)
            continue
        items = []
        for _ in range(min(count, len(data))):
            before = at
            item, at = _one(field.kind, types, data, at, depth)
            items.append(item)
            if at == before:
                raise InvalidInputError(f"array {field.name}", "elements of 0 bytes", "some")
        value[field.name] = items
    return value, at


def _one(
    kind: str, types: dict[str, list[_Field]], data: bytes, at: int, depth: int
) -> tuple[object, int]:
    if kind in SCALARS:
        code = f"<{SCALARS[kind]}"
        return struct.unpack_from(code, data, at)[0], at + struct.calcsize(code)
    if kind in PAIRS:
        seconds, nanoseconds = struct.unpack_from(PAIRS[kind], data, at)
        return {"sec": seconds, "nanosec": nanoseconds}, at + 8
    if kind == "string":
        (size,) = struct.unpack_from("<I", data, at)
        return data[at + 4 : at + 4 + size].decode("utf-8", "replace"), at + 4 + size
    return _message(kind, types, data, at, depth + 1)
