"""refusal: one line for the first thing that is wrong with a table of a file."""

from __future__ import annotations

import difflib
from typing import get_args

from pydantic import BaseModel, ValidationError

from ves_twin.core.errors import InvalidInputError, UnknownNameError, VesTwinError


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
