"""read_toml: a TOML file as a table, or one line that says what is wrong with it."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

from ves_twin.core.errors import FileAccessError, InvalidInputError, VersionError


def read_toml(kind: str, path: Path) -> tuple[dict[str, Any], str]:
    """Content and text of a TOML file.

    Args:
        kind: word for messages, for instance "plant".
        path: the file.

    Raises:
        FileAccessError: not readable.
        InvalidInputError: not TOML, or nested beyond reason.
    """
    try:
        text = path.read_text(encoding="utf-8")
        return tomllib.loads(text), text
    except OSError as error:
        raise FileAccessError(f"{kind} {path}: {error.strerror}") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InvalidInputError(f"{kind} {path}", str(error), "valid TOML") from None
    except RecursionError:
        raise InvalidInputError(f"{kind} {path}", "endless nesting", "valid TOML") from None


def check_schema(content: dict[str, Any], path: Path, expected: int) -> None:
    """Raise VersionError unless the content says `schema = expected`."""
    found = content.get("schema")
    if type(found) is not int or found != expected:
        raise VersionError(path, found, expected)
