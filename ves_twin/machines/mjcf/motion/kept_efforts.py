"""KeptEfforts: efforts along the recorded motions of one model, as many as fit in a memory."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from threading import RLock

from ves_twin.machines.mjcf.parts.rigid_efforts import RigidEfforts

WHOLE = 1e9
"""Bytes that directions of all motions may take: a minute of a seven-axis arm at 1 kHz, in
stretches of 2 s, takes a quarter of it."""


IDLE = 100
"""Rounds over as many motions as are kept after which one that nobody asks for makes room: it is of
another diagnosis, as of the day before in a trend."""


class KeptEfforts:
    """Efforts by the motion that they are of; those that came first stay.

    A fit goes round all recordings again and again: whoever drops the oldest one keeps none of
    them where one too many has come (of a minute at 1 kHz in 75 stretches, where 64 were kept,
    each round took 50 s in place of 6).

    Args:
        most: bytes of all directions.
    """

    def __init__(self, most: float = WHOLE) -> None:
        self._left, self._asked = most, 0
        self._found: dict[Hashable, RigidEfforts] = {}
        self._told: dict[Hashable, tuple[int, int]] = {}  # size, and when it was asked for
        self._lock = RLock()

    def of(
        self, motion: Hashable, size: int, made: Callable[[], RigidEfforts]
    ) -> RigidEfforts | None:
        """Those of a motion; None where there is no room for them.

        Args:
            motion: equal to another one if its efforts are.
            size: of its directions [bytes].
            made: makes them, where they are not there.
        """
        with self._lock:
            self._asked += 1
            if motion not in self._found:
                if size > self._left:
                    self._make_room()
                if size > self._left:
                    return None
                self._left -= size
                self._found[motion] = made()
            self._told[motion] = size, self._asked
            return self._found[motion]

    def _make_room(self) -> None:
        """Drop what has not been asked for in IDLE rounds."""
        since = self._asked - IDLE * len(self._found)
        for motion in [one for one, (_, last) in self._told.items() if last < since]:
            self._left += self._told.pop(motion)[0]
            del self._found[motion]
