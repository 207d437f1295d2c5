"""json_text: plain values as JSON that any reader takes, numbers that are not finite as null."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from math import isfinite


def json_text(content: object, indent: int | None = 2) -> str:
    """Content as JSON (RFC 8259), which knows neither Infinity nor NaN: they become null.

    Args:
        content: mappings, sequences, text, numbers and None, nested.
        indent: spaces a level; one line if None.

    Raises:
        TypeError: something that is no plain value.
    """
    return json.dumps(_finite(content), indent=indent, allow_nan=False)


def _finite(value: object) -> object:
    if isinstance(value, float):
        return value if isfinite(value) else None
    if isinstance(value, Mapping):
        return {key: _finite(entry) for key, entry in value.items()}
    if isinstance(value, Sequence) and not isinstance(value, str | bytes):
        return [_finite(entry) for entry in value]
    return value
