"""LastRuns: the last few predictions of each recording, and columns, for whoever asks again."""

from __future__ import annotations

from collections import OrderedDict

from ves_twin.core.types import SingleArray

KEPT = 4
"""Predictions of each recording that are kept: the point itself, and what was tried beside it."""

Key = tuple[int, bool, bytes]
"""Recording, whether by half the step, and its own departures."""


class LastRuns:
    """Predictions by what they are of; a copy in another process begins empty.

    Args:
        kept: of each recording.
    """

    def __init__(self, kept: int = KEPT) -> None:
        self._kept = kept
        self._found: dict[int, OrderedDict[Key, SingleArray]] = {}

    def __reduce__(self) -> tuple[type[LastRuns], tuple[int]]:
        return LastRuns, (self._kept,)

    def get(self, key: Key) -> SingleArray | None:
        """As it was kept, and kept on; None if it was not."""
        there = self._found.get(key[0], OrderedDict())
        if key in there:
            there.move_to_end(key)
        return there.get(key)

    def keep(self, key: Key, rows: SingleArray) -> None:
        """In place of the one of this recording that was asked for longest ago."""
        there = self._found.setdefault(key[0], OrderedDict())
        there[key] = rows
        if len(there) > self._kept:
            there.popitem(last=False)
