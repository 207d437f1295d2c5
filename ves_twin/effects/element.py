"""Element: the parts of a model that attributes and effects belong to."""

from __future__ import annotations

from enum import StrEnum


class Element(StrEnum):
    """Kinds of parts."""

    BODY = "body"
    JOINT = "joint"
    ACTUATOR = "actuator"
    SIGNAL = "signal"
    TENDON = "tendon"
    WORLD = "world"
    LOG = "log"
