"""Engine: carries out points somewhere and hands over each result as it comes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Protocol

from ves_twin.sweeps.point import Point
from ves_twin.sweeps.result import PointResult

Beat = Callable[[], None]
"""Called several times a second while an engine waits; it may raise KeyboardInterrupt."""

BEAT = 0.2
"""Longest wait between two beats [s]."""

TRIES = 3
"""A point whose worker died this often is given up: more would not tell anything new."""


class Engine(Protocol):
    """Where points run."""

    def results(self, points: Sequence[Point], beat: Beat) -> Iterator[PointResult]:
        """Results of the points, in any order, each once.

        A point whose worker dies is tried again on another one; after TRIES it is lost. Closing
        the iterator stops the workers.

        Raises:
            VesTwinError: a worker that cannot take part in this sweep.
        """
