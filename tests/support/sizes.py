"""nightly_but: parameters of a test of which `make test` tries a few, `make nightly` all."""

from collections.abc import Sequence
from typing import Any

import pytest


def nightly_but(first: int, values: Sequence[Any]) -> list[Any]:
    """The values, those after the first few marked `nightly`; a tuple is a set of arguments."""
    return [
        pytest.param(
            *(value if isinstance(value, tuple) else (value,)),
            marks=[] if k < first else pytest.mark.nightly,
        )
        for k, value in enumerate(values)
    ]
