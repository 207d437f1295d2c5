"""Budget: the time that work may take, stage by stage, and what was left out for want of it."""

from __future__ import annotations

import math
import time
from collections.abc import Callable

from ves_twin.core.errors import InvalidInputError


class EndedError(Exception):
    """Work was ended while it computed what nothing can be told without."""


class Budget:
    """Time from now on; work asks it between steps whether to go on.

    Args:
        minutes: for everything; endless if left out.
        clock: of the time that is spent [s]: of this process, or one that all processes share.

    Attributes:
        tells: whether the work, ended now, has something to tell.

    Raises:
        InvalidInputError: minutes that are not above zero.
    """

    def __init__(
        self, minutes: float = math.inf, clock: Callable[[], float] = time.process_time
    ) -> None:
        if not minutes > 0.0:
            raise InvalidInputError("minutes", minutes, "above zero")
        self.minutes, self.left_out = minutes, list[str]()
        self._clock, self._begun, self._until = clock, clock(), 1.0
        self.tells, self._ended = False, False

    def stage(self, until: float) -> None:
        """The present stage ends where this share of the whole is spent."""
        self._until = until

    def end(self) -> bool:
        """All stages end now, if what is known by now `tells` something; whether it does."""
        self._ended = self.tells
        return self.tells

    def stop_if_ended(self) -> None:
        """Within a part that tells nothing before its end.

        Raises:
            EndedError: all was ended.
        """
        if self._ended:
            raise EndedError

    @property
    def spent(self) -> float:
        """Share of the whole; without end once it was ended."""
        if self._ended:
            return math.inf
        return (self._clock() - self._begun) / (60.0 * self.minutes)

    @property
    def over(self) -> bool:
        """Whether the present stage must come to an end."""
        return self.spent >= self._until

    def skips(self, what: str) -> bool:
        """Whether a part of the work is left out since the stage is over; keeps its name."""
        if self.over:
            self.leave_out(what)
        return self.over

    def leave_out(self, what: str) -> None:
        """Keep the name of what is left out."""
        if what not in self.left_out:
            self.left_out.append(what)
