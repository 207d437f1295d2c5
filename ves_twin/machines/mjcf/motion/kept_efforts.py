"""KeptEfforts: efforts along the recorded motions of one model, as many as fit in a memory."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from threading import RLock

from ves_twin.machines.mjcf.parts.rigid_efforts import RigidEfforts

WHOLE = 1e9
"""Bytes that directions of all motions may take: a minute of a seven-axis arm at 1 kHz, in
stretches of 2 s, takes a quarter of it."""


class KeptEfforts:
    """Efforts by the motion that they are of; those that came first stay.

    A fit goes round all recordings again and again: whoever drops the oldest one keeps none of
    them where one too many has come (of a minute at 1 kHz in 75 stretches, where 64 were kept,
    each round took 50 s in place of 6).

    Args:
        most: bytes of all directions.
    """

    def __init__(self, most: float = WHOLE) -> None:
        self._left = most
        self._found: dict[Hashable, RigidEfforts] = {}
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
            if motion not in self._found:
                if size > self._left:
                    return None
                self._left -= size
                self._found[motion] = made()
            return self._found[motion]
