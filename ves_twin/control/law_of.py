"""law_of: what the compiled cycle runs in place of a controller or compensation, if anything."""

from __future__ import annotations

from ves_twin.control.controller import PlatformController
from ves_twin.control.gravity import GravityCompensation
from ves_twin.core.types import Block


def law_of(thing: PlatformController | GravityCompensation) -> Block | None:
    """Its LAW, or None: then the interpreter asks it in each cycle.

    A law says what its own class does, so a class that was derived from it has none.
    """
    return thing.law if "law" in vars(type(thing)) else None
