"""scenario_content: read and override a scenario file, and say what is wrong with it."""

from __future__ import annotations

import copy
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.resources import beside, find_resource, resource_folder
from ves_twin.core.toml_file import parse_toml, read_toml

FILE_KEYS = (
    ("plant",),
    ("belief",),
    ("scenario",),
    ("platform", "emulated"),
    ("platform", "motion", "file"),
    ("gravity", "file"),
    ("arm", "operator"),
)
"""Keys of scenarios and procedures that name a file."""


def scenario_content(
    name_or_path: str, changes: Mapping[str, object]
) -> tuple[dict[str, Any], str]:
    """Content of a scenario by name or from a file, with some keys changed, not yet validated.

    Args:
        name_or_path: "beam_horizontal_truth", or a path to a TOML file.
        changes: dotted keys to values, for instance {"legs.gain": 16.0}.

    Returns:
        The content with name and question, and the file's name for messages.

    Raises:
        FileAccessError: missing or unreadable file.
        UnknownNameError: unknown scenario; says the nearest one.
        InvalidInputError: not TOML, or no question.
    """
    path = find_resource("scenario", "scenarios", name_or_path)
    content, question = _read(path)
    _find_beside(content, path)
    for key, value in changes.items():
        content = _with_key(content, key, value)
    name = re.sub(r"[^A-Za-z0-9_.-]", "_", path.stem)[:64]
    return {"name": name, "question": question, **content}, path.name


def scenario_questions() -> dict[str, str]:
    """Every scenario that is shipped: name -> the question it answers."""
    return {name: question for name, (content, question) in _shipped() if not _is_many(content)}


def procedure_questions() -> dict[str, str]:
    """Every procedure that is shipped (many runs, one result): name -> its question."""
    return {name: question for name, (content, question) in _shipped() if _is_many(content)}


def _is_many(content: Mapping[str, object]) -> bool:
    return "procedure" in content


def _shipped() -> list[tuple[str, tuple[dict[str, Any], str]]]:
    paths = sorted(resource_folder("scenarios").glob("*.toml"))
    return [(path.stem, _read(path)) for path in paths]


def parse_setting(text: str) -> tuple[str, object]:
    """A command-line override "a.b=VALUE": VALUE is read as TOML, else taken as text.

    Raises:
        InvalidInputError: no equals sign or no key.
    """
    key, equals, value = text.partition("=")
    if not equals or not key.strip():
        raise InvalidInputError("--set", text, "KEY=VALUE, for instance legs.gain=16")
    try:
        return key.strip(), parse_toml(f"value = {value}")["value"]
    except (ValueError, RecursionError):  # not TOML, or a number or nesting beyond reason
        return key.strip(), value.strip()


def _read(path: Path) -> tuple[dict[str, Any], str]:
    content, text = read_toml("scenario", path)
    first = text.lstrip().split("\n", 1)[0]
    if not first.startswith("#"):
        raise InvalidInputError(
            f"scenario {path}", first, "a first line '# ...' with the question it answers"
        )
    return content, first.lstrip("# ").strip()


def _find_beside(content: Mapping[str, Any], path: Path) -> None:
    """Files that a scenario names lie beside its own file, wherever it is run from."""
    for *parents, key in FILE_KEYS:
        table: object = content
        for parent in parents:
            table = table.get(parent) if isinstance(table, dict) else None
        if isinstance(table, dict) and isinstance(file := table.get(key), str):
            table[key] = beside(path, file)


def _with_key(content: Mapping[str, Any], key: str, value: object) -> dict[str, Any]:
    result: dict[str, Any] = copy.deepcopy(dict(content))
    if key.startswith("parameters."):  # their names hold dots themselves
        table = result.setdefault("parameters", {})
        if isinstance(table, dict):
            table[key.removeprefix("parameters.")] = value
        return result
    node = result
    *parents, last = key.split(".")
    for parent in parents:
        child = node.setdefault(parent, {})
        if not isinstance(child, dict):
            raise InvalidInputError("--set", key, f"a key; '{parent}' is not a table")
        node = child
    node[last] = value
    return result
