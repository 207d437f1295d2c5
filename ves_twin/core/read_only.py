"""ReadOnly: a frozen dataclass whose arrays are frozen, too."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

import numpy as np


class ReadOnly:
    """Base of frozen dataclasses: their arrays, alone, in a tuple or a mapping, cannot be written.

    They are views: whoever made an array and holds it may write it still.
    """

    def __post_init__(self) -> None:
        for field in fields(self):  # type: ignore[arg-type]  # of a dataclass
            value = getattr(self, field.name)
            if isinstance(value, np.ndarray):
                object.__setattr__(self, field.name, _read_only(value))
            elif type(value) is tuple:
                object.__setattr__(self, field.name, tuple(map(_read_only, value)))
            elif isinstance(value, Mapping):
                kept = {key: _read_only(item) for key, item in value.items()}
                object.__setattr__(self, field.name, kept)

    def __setstate__(self, state: dict[str, Any]) -> None:
        """A copy, or what another process sent, is made without `__init__`."""
        self.__dict__.update(state)
        ReadOnly.__post_init__(self)


def _read_only(value: Any) -> Any:
    if not isinstance(value, np.ndarray):
        return value
    view = value.view()
    view.flags.writeable = False
    return view
