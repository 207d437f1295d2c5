"""toml_text: a text, or a list of texts, as a TOML file writes it."""

from __future__ import annotations

import json
from collections.abc import Sequence


def toml_text(value: str | Sequence[str]) -> str:
    """Quoted and escaped; letters of any alphabet stay as they are."""
    return json.dumps(value if isinstance(value, str) else list(value), ensure_ascii=False)
