"""Variation: one key of a scenario and the values that a sweep gives it."""

from __future__ import annotations

import re
from dataclasses import dataclass

from ves_twin.core.errors import InvalidInputError
from ves_twin.scenario.load import parse_setting

MOST_VALUES = 100_000
"""Values of one key, and points of a sweep: beyond that the plan alone takes minutes."""

_EXPECTED = "KEY=V1,V2,..., KEY=LO..HI:N for N even steps, or KEY=LO..HI with --random"
_RANGE = re.compile(r"(?P<low>.+?)\.\.(?P<high>.+?)(?::(?P<steps>\d+))?")
_SHORT = {"seed": "run.seed"}
"""Keys that have a short name."""


@dataclass(frozen=True)
class Span:
    """A range of one key: its ends as they stand in a file, and into how many it is divided.

    `steps` is 0 for a range that random points are drawn from.
    """

    low: object
    high: object
    steps: int


@dataclass(frozen=True)
class Variation:
    """One varied key.

    Attributes:
        key: dotted key of the scenario, all that `run --set` takes.
        text: what came, which is part of the sweep's identity.
        values: the values of a list; empty for a range.
        span: the range; None for a list.
    """

    key: str
    text: str
    values: tuple[object, ...] = ()
    span: Span | None = None

    @staticmethod
    def parse(text: str) -> Variation:
        """A variation from "legs.gain=8,12,16", "legs.gain=8..20:5" or "legs.gain=8..20".

        A value is written as in `run --set`: a number, a text with a unit, a list in brackets.

        Raises:
            InvalidInputError: no key, no value, or a range without an end.
        """
        key, equals, right = text.partition("=")
        key = _SHORT.get(key.strip(), key.strip())
        parts = _split(right)
        if not equals or not key or not all(parts):
            raise InvalidInputError("--vary", text, _EXPECTED)
        span = _span(key, parts[0]) if len(parts) == 1 else None
        if span is not None:
            return Variation(key, right, span=span)
        return Variation(key, right, tuple(_value(key, part) for part in parts))


def _value(key: str, text: str) -> object:
    return parse_setting(f"{key}={text}")[1]


def _span(key: str, text: str) -> Span | None:
    """The range of a text, or None where it is not one; a path may hold two dots as well."""
    match = _RANGE.fullmatch(text)
    if match is None or "/" in text or text[0] in "[{\"'":
        return None
    steps = int(match["steps"][:9]) if match["steps"] else 0
    if match["steps"] and not 2 <= steps <= MOST_VALUES:
        raise InvalidInputError(f"--vary {key}", text, f"2 to {MOST_VALUES} steps")
    return Span(_value(key, match["low"]), _value(key, match["high"]), steps)


def _split(text: str) -> list[str]:
    """Parts between commas that stand outside brackets and quotes."""
    parts, depth, quote = [""], 0, ""
    for letter in text:
        if quote:
            quote = "" if letter == quote else quote
        elif letter in "\"'":
            quote = letter
        depth += (letter in "[{") - (letter in "]}") if not quote else 0
        if letter == "," and depth <= 0 and not quote:
            parts.append("")
        else:
            parts[-1] += letter
    return [part.strip() for part in parts]
