"""scenario_content: read and override a scenario file, and say what is wrong with it."""

from __future__ import annotations

import copy
import difflib
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any, get_args

from pydantic import BaseModel, ValidationError

from ves_twin.core.errors import InvalidInputError, UnknownNameError, VesTwinError
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


def refusal(error: ValidationError, where: str, model: type[BaseModel]) -> VesTwinError:
    """What to raise for a content that a model refused: one line for the first thing wrong.

    Args:
        error: what the validation found.
        where: name of the file.
        model: what the content was validated against.

    Returns:
        UnknownNameError for an unknown key, with the nearest one; InvalidInputError otherwise,
        with the key, what came and what was expected.
    """
    found = error.errors(include_url=False)
    first = next((e for e in found if e["type"] == "extra_forbidden"), found[0])
    location, parents = _without_tags(model, [str(part) for part in first["loc"]])
    key = ".".join(location) or "content"
    if first["type"] == "union_tag_invalid":
        context = first["ctx"]
        known = [tag.strip("' ") for tag in context["expected_tags"].split(",")]
        return UnknownNameError(f"{where}: {key}.kind", context["tag"], known)
    if first["type"] == "extra_forbidden":
        keys = list(parents[-1].model_fields)
        near = difflib.get_close_matches(location[-1], keys, n=1, cutoff=0.5)
        known = [".".join([*location[:-1], near[0]])] if near else keys
        return UnknownNameError(f"key in {where}", key, known)
    if first["type"] == "missing":
        return InvalidInputError(f"{where}: {key}", None, "a value; it has no default")
    message = first["msg"].removeprefix("Value error, ").removeprefix("value: ")
    message = message.replace("Input should be ", "")
    if first["type"] == "value_error":
        at = f"{where}: {key}" if location else where  # else the message names its keys
        return InvalidScenarioError(f"{at}: {message}")
    return InvalidInputError(f"{where}: {key}", first["input"], message[0].lower() + message[1:])


class InvalidScenarioError(InvalidInputError):
    """A scenario value that was refused with a sentence of its own."""

    def __init__(self, message: str) -> None:
        Exception.__init__(self, message)


def _without_tags(
    model: type[BaseModel], location: list[str]
) -> tuple[list[str], list[type[BaseModel]]]:
    """A location as a file has it, without the kinds that choose among tables; and its tables."""
    path: list[str] = []
    models = [model]
    choices: list[type[BaseModel]] = []
    for part in location:
        tagged = [m for m in choices if _tag(m) == part]
        if tagged:
            models.append(tagged[0])
        else:
            path.append(part)
            if len(choices) == 1 and not part.isdigit():
                models.append(choices[0])
        field = None if part.isdigit() else models[-1].model_fields.get(part)
        if field is not None:
            choices = _models_in(field.annotation)
    return path, models


def _models_in(annotation: object) -> list[type[BaseModel]]:
    found = [a for a in (annotation, *_flatten(annotation)) if isinstance(a, type)]
    return [a for a in found if issubclass(a, BaseModel)]


def _tag(model: type[BaseModel]) -> str | None:
    kind = model.model_fields.get("kind")
    values = get_args(kind.annotation) if kind is not None else ()
    return str(values[0]) if values else None


def _flatten(annotation: object) -> list[object]:
    inner: list[object] = []
    for argument in get_args(annotation):
        inner += [argument, *_flatten(argument)]
    return inner
