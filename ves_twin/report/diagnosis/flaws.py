"""flaws: what quality checks found wrong with recordings, the first of each sort first."""

from __future__ import annotations

from collections.abc import Sequence

from ves_twin.data.quality.check import Check

FLAWS = 2
"""Flaws of a sort that are told first."""

RESTS = "The recordings have flaws that the verdict may rest on:"


def flaws(checks: Sequence[Check]) -> tuple[list[str], list[str]]:
    """Messages of checks that did not pass: the first ones of each sort, and all others."""
    sorts: dict[str, list[str]] = {}
    for check in checks:
        sorts.setdefault(check.name, []).append(check.message)
    first, more = (
        [line for lines in sorts.values() for line in lines[part]]
        for part in (slice(FLAWS), slice(FLAWS, None))
    )
    return first, more


def flaw_lines(checks: Sequence[Check]) -> list[str]:
    """The same for a terminal; none where all is well."""
    first, more = flaws(checks)
    if not first:
        return []
    lines = [RESTS, *(f"  {text}" for text in first)]
    return [*lines, f"  {len(more)} more like these"] if more else lines
