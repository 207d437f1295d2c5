"""Trend: what recordings of different days say together, as it stands in trend.json."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from enum import StrEnum
from pathlib import Path

from ves_twin.core.whole_file import write_whole
from ves_twin.diagnosis.trend.calendar import Calendar
from ves_twin.diagnosis.trend.change import Change
from ves_twin.diagnosis.trend.one_rig import OneRig
from ves_twin.diagnosis.verdict.verdict import Basis, Findable

SCHEMA = 1
"""Version of trend.json; fields are added without a new one, never changed."""


class Answer(StrEnum):
    """The answers.

    nothing: no cause on any day, and no change. constant: a cause as large on every day. step,
    ramp: a change at a date. varies: sizes that differ without a trend. mixed: recordings of more
    than one machine, or of one in which several things changed. unknown: days on which something
    is wrong that the library does not explain.
    """

    NOTHING = "nothing"
    CONSTANT = "constant"
    STEP = "step"
    RAMP = "ramp"
    VARIES = "varies"
    MIXED = "mixed"
    UNKNOWN = "unknown"


@dataclass(frozen=True)
class DaySize:
    """The cause in one recording.

    Attributes:
        recording: its name.
        date: as people say it, or the number of the recording.
        day: days from the first recording, or its number.
        value: of the parameter [its unit], not held to its bounds.
        low, high: interval, all commissioning errors marginalised.
        sd: against the other days: what the days share is no part of it.
        left: largest cell score that is left, beside what noise passes.
        explained: whether that is noise.
    """

    recording: str
    date: str
    day: float
    value: float
    low: float
    high: float
    sd: float
    left: float
    explained: bool


@dataclass(frozen=True)
class FollowedCause:
    """The cause whose size is followed.

    Attributes:
        effect, target: what and where.
        parameter, unit, nominal: of its size.
        firm: False where a commissioning error of `sigmas` declared sd is not excluded; of a
            change, which commissioning does not make, always True.
        sigmas: of the constant part, in declared sd; None if it is no commissioning parameter.
        rivals: label -> chi^2 by which another cause, followed likewise, fits worse; those within
            the odds are as good.
        equals: labels of rivals that are as good.
    """

    effect: str
    target: str
    parameter: str
    unit: str
    nominal: float
    firm: bool
    sigmas: float | None
    rivals: Mapping[str, float] = field(default_factory=dict)
    equals: tuple[str, ...] = ()

    @property
    def label(self) -> str:
        """effect@target."""
        return f"{self.effect}@{self.target}"


@dataclass(frozen=True)
class TrendStatistics:
    """Best change, daily and constant size over the library, each beside its limit."""

    change: float
    change_limit: float
    varies: float
    varies_limit: float
    constant: float
    constant_limit: float


@dataclass(frozen=True)
class Trend:
    """What was found over the days.

    `false_alarm` is the stated rate, for the whole series, of each of: a change (step, ramp, sizes
    that vary), a constant cause, two machines, something unexplained. `unexplained` are recordings
    in which something stays that is no noise. `smallest_change` is the step in the middle of the
    series that is found seven times out of ten.
    """

    answer: Answer
    false_alarm: float
    basis: Basis
    statistics: TrendStatistics
    one_rig: OneRig
    recordings: tuple[str, ...]
    calendar: Calendar
    cause: FollowedCause | None = None
    sizes: tuple[DaySize, ...] = ()
    change: Change | None = None
    unexplained: tuple[str, ...] = ()
    smallest_change: Mapping[str, Findable] = field(default_factory=dict)
    not_followed: tuple[str, ...] = ()
    excluded: tuple[str, ...] = ()
    schema: int = SCHEMA

    def to_json(self) -> str:
        """The text of trend.json: dates beside days, causes by effect and target."""
        content = asdict(self)
        told = content.pop("calendar")
        content["unit"] = self.calendar.unit
        content["days"] = sorted(told["days"])
        content["dates"] = [self.calendar.words(day) for day in content["days"]]
        if self.change is not None and self.change.onset is not None:
            onset = self.change.onset
            ends = {name: getattr(onset, name) for name in ("value", "low", "high")}
            dated = {name: self.calendar.words(day) for name, day in ends.items()}
            content["change"]["onset_date"] = dated
        return json.dumps(content, indent=2, allow_nan=False)

    def save(self, path: Path) -> None:
        """Write trend.json.

        Raises:
            FileAccessError: not writable.
        """
        write_whole(path, self.to_json() + "\n")
