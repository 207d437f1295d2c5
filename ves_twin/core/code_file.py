"""load_class: a class out of a Python file that a user names on the command line."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import Any

from ves_twin.core.errors import InvalidInputError, PluginError, UnknownNameError, one_line
from ves_twin.core.missing_file import missing_file
from ves_twin.core.plugins import lacks


def load_class(text: str, base: type) -> type[Any]:
    """The class of "FILE:Class", which runs the file; nothing but a flag may lead here.

    Args:
        text: path of a Python file, a colon, the name of a class in it.
        base: what it must derive from.

    Raises:
        InvalidInputError: a text of another form.
        FileAccessError: no such file.
        UnknownNameError: no such class in it; says the nearest one.
        PluginError: the file cannot be run, or the class is of another kind or lacks methods.
    """
    name, colon, wanted = text.rpartition(":")
    if not colon or not wanted.isidentifier() or not name.endswith(".py"):
        raise InvalidInputError("code", text, "FILE.py:Class, for instance my_policy.py:MyPolicy")
    path = Path(name)
    if not path.is_file():
        raise missing_file("code", name)
    spec = importlib.util.spec_from_file_location(path.stem, path)
    if spec is None or spec.loader is None:
        raise PluginError(f"{name} cannot be run as Python")
    module = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        what = f"{type(error).__name__}: {one_line(error)}"
        raise PluginError(f"{name} cannot be run: {what}") from error
    found: Any = getattr(module, wanted, None)
    if found is None:
        classes = [n for n, v in vars(module).items() if isinstance(v, type)]
        raise UnknownNameError(f"class in {name}", wanted, classes)
    wrong = lacks(base)(found)
    if wrong is not None:
        raise PluginError(f"{text} {wrong}")
    return found  # type: ignore[no-any-return]
