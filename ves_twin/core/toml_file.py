"""read_toml, write_toml: a TOML file as a table, or one line that says what is wrong with it."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ves_twin.core.errors import FileAccessError, InvalidInputError, VersionError
from ves_twin.core.whole_file import write_whole


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
        return parse_toml(text), text
    except OSError as error:
        raise FileAccessError(f"{kind} {path}: {error.strerror}") from None
    except ValueError as error:  # not TOML, not UTF-8, or a number beyond reason
        raise InvalidInputError(f"{kind} {path}", str(error), "valid TOML") from None
    except RecursionError:
        raise InvalidInputError(f"{kind} {path}", "endless nesting", "valid TOML") from None


def parse_toml(text: str) -> dict[str, Any]:
    """Content of a TOML text; raises ValueError, also at integers beyond the 64 bits of TOML."""
    content = tomllib.loads(text)
    waiting: list[object] = [content]
    while waiting:
        value = waiting.pop()
        if isinstance(value, dict):
            waiting += value.values()
        elif isinstance(value, list):
            waiting += value
        elif isinstance(value, int) and not -(2**63) <= value < 2**63:
            raise ValueError(f"an integer of {value.bit_length()} bits, TOML has 64")
    return content


def write_toml(path: Path, content: Mapping[str, object], note: str = "") -> None:
    """Write a table below the lines of a note; what was there stays until the new file is whole.

    Raises:
        FileAccessError: not writable.
    """
    import tomli_w  # only who writes needs it

    comment = "".join(f"# {line}\n" for line in note.splitlines())
    write_whole(path, comment + tomli_w.dumps(content))


def check_schema(content: dict[str, Any], path: Path, expected: int) -> None:
    """Raise VersionError unless the content says `schema = expected`."""
    found = content.get("schema")
    if type(found) is not int or found != expected:
        raise VersionError(path, found, expected)
