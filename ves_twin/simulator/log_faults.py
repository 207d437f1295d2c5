"""LogFaults: what a faulty recorder writes of the rows that it is handed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np

from ves_twin.core.read_only import ReadOnly
from ves_twin.core.types import FloatArray
from ves_twin.effects.effect import Effect
from ves_twin.effects.element import Element
from ves_twin.effects.place import Place

MEMORY = 0.1
"""Stretch of rows that is kept [s]: twice the longest delay of a recorder."""


@dataclass(frozen=True)
class LogTail(ReadOnly):
    """The last rows as they were handed over: time [s] (n,) and signals (n, width)."""

    time: FloatArray = field(default_factory=lambda: np.zeros(0))
    signals: Mapping[str, FloatArray] = field(default_factory=dict)


class LogFaults:
    """Edits signals on their way into the log, in pieces of any length.

    Args:
        effects: of a plant; those of the log alone count.
    """

    def __init__(self, effects: Iterable[Effect]) -> None:
        self._effects = tuple(effect for effect in effects if effect.log)
        self.tail = LogTail()

    def logged(self, time: FloatArray, signals: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
        """What the log holds of the next rows: time [s] (n,), signals (n, width)."""
        found, kept = dict(signals), {}
        before = self.tail
        every = np.concatenate([before.time, time])
        last = slice(int(np.searchsorted(every, every[-1] - MEMORY)), None)
        for name in {effect.log for effect in self._effects} & found.keys():
            true = np.concatenate([before.signals.get(name, found[name][:0]), found[name]])
            found[name] = logged(self._effects, name, every, true)[len(before.time) :]
            kept[name] = true[last]
        self.tail = LogTail(every[last], kept) if self._effects else before
        return found


def logged(
    effects: Iterable[Effect], signal: str, time: FloatArray, true: FloatArray
) -> FloatArray:
    """What the log holds (n, w) of a signal that was (n, w), by those effects that are of it."""
    reading = true
    for effect in effects:
        if effect.log == signal:
            place = Place(Element.SIGNAL, effect.target)
            reading = effect.edit_reading(reading, true, time, place)
    return reading
