"""Calendar: dates of recordings as days, and days as people say them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta

from ves_twin.core.errors import InvalidInputError


@dataclass(frozen=True)
class Calendar:
    """Dates of recordings, or their numbers where there are none.

    Attributes:
        first: earliest date; None where recordings are only numbered.
        days: since then, or the numbers from 1.
        timed: whether the time of day is told.
    """

    first: datetime | None
    days: tuple[float, ...]
    timed: bool = False

    @staticmethod
    def of(names: Sequence[str], dates: Sequence[datetime | None]) -> Calendar:
        """Of recordings in the order in which they are numbered.

        Raises:
            InvalidInputError: some have a date and some have none.
        """
        known = [date for date in dates if date is not None]
        if not known:
            return Calendar(None, tuple(float(n + 1) for n in range(len(dates))))
        if len(known) < len(dates):
            lost = next(name for name, date in zip(names, dates, strict=True) if date is None)
            raise InvalidInputError(
                f"date of {lost}", "none in its name", "one as in 2026-03-14.csv, or --numbered"
            )
        first = min(known)
        days = tuple((date - first).total_seconds() / 86400.0 for date in known)
        return Calendar(first, days, len({date.date() for date in known}) < len(known))

    def words(self, day: float) -> str:
        """A day as a date, or as the number of a recording."""
        if self.first is None:
            return f"recording {day:g}" if float(day).is_integer() else f"recording {day:.1f}"
        date = self.first + timedelta(days=day)
        return date.strftime("%Y-%m-%d %H:%M" if self.timed else "%Y-%m-%d")

    @property
    def unit(self) -> str:
        """What a slope is by."""
        return "day" if self.first is not None else "recording"
