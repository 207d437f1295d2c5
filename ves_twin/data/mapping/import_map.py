"""ImportMap: which column of a lab file is which signal, validated from TOML."""

from __future__ import annotations

import re
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Self

from pydantic import Field, ValidationError, field_validator, model_validator

from ves_twin.core.errors import InvalidInputError, shown
from ves_twin.core.refusal import refusal
from ves_twin.core.signals import SIGNALS, Role, Signal
from ves_twin.core.toml_file import check_schema, read_toml
from ves_twin.core.units import check_known
from ves_twin.data.formats.unit_names import TIME, spelled
from ves_twin.scenario.fields import Hertz, Part, Seconds, named

SCHEMA = 1
MAIN = "main"
"""Name of the clock that the rows of the recording come from."""


NAME = re.compile(r"[^\W\d_]\w*(\.[^\W\d]\w*)*")
"""Of a signal of one's own: it becomes a column of CSV and a variable of MATLAB."""


class Repeats(StrEnum):
    """Which of the rows that have one time is kept."""

    FIRST = "first"
    LAST = "last"
    REFUSE = "refuse"


class Backward(StrEnum):
    """What becomes of rows that step back in time."""

    REFUSE = "refuse"
    DROP = "drop"
    SORT = "sort"


class Gaps(StrEnum):
    """What stands in a gap: nothing, or the value before it."""

    NAN = "nan"
    HOLD = "hold"


class Way(StrEnum):
    """How a channel gets onto the rows.

    AUTO: as it is on its own rows; a command, and whatever is slower, held; what is faster,
    filtered. FILTER: low-pass below half the rate of the rows, then read off between rows. HOLD:
    the newest value. LINEAR: straight between rows.
    """

    AUTO = "auto"
    FILTER = "filter"
    HOLD = "hold"
    LINEAR = "linear"


class Keep(StrEnum):
    """What becomes of an offset between clocks: taken off, or noted for the diagnosis."""

    REMOVED = "removed"
    HYPOTHESIS = "hypothesis"


class ClockMap(Part):
    """A clock of the file: a column, or a rate where no column tells the time.

    `even` says that the rows were taken evenly and only their stamps jitter: a straight line is
    drawn through the stamps, with the rows that gaps swallowed counted.
    """

    column: str | None = None
    unit: Annotated[str, named("unit of time", TIME)] | None = None
    rate: Annotated[Hertz, Field(gt=0)] | None = None
    repeats: Annotated[Repeats, named("choice", list(Repeats))] = Repeats.FIRST
    backward: Annotated[Backward, named("choice", list(Backward))] = Backward.REFUSE
    even: bool = False

    @model_validator(mode="after")
    def _one_of_two(self) -> Self:
        if (self.column is None) == (self.rate is None):
            raise ValueError("clock: expected either column or rate")
        return self


class OtherClock(ClockMap):
    """Another recorder's clock, and what is known of its offset.

    `offset` [s] is what is added to its readings to get the main clock's, or "estimate": from
    two columns that saw the same motion, `own` on this clock and `main` on the main one.
    """

    offset: Seconds | str = 0.0
    own: str | None = None
    main: str | None = None
    search: Annotated[Seconds, Field(gt=0, le=3600)] = 10.0
    keep: Annotated[Keep, named("choice", list(Keep))] = Keep.REMOVED

    @model_validator(mode="after")
    def _estimate_has_a_pair(self) -> Self:
        estimated = isinstance(self.offset, str)
        if estimated and self.offset != "estimate":
            raise ValueError(f"offset: got {self.offset!r}, expected seconds or 'estimate'")
        if estimated != (self.own is not None and self.main is not None):
            raise ValueError("offset: 'estimate' goes with own and main, two columns")
        return self


class OwnSignal(Part):
    """A signal that the rig's table lacks; one column for each axis."""

    unit: str | tuple[str, ...]
    axes: tuple[str, ...] = ()
    role: Annotated[Role, named("role", list(Role))] = Role.MEASUREMENT
    frame: str = ""
    meaning: str = ""

    @field_validator("unit")
    @classmethod
    def _units_are_known(cls, unit: str | tuple[str, ...]) -> str | tuple[str, ...]:
        given = (unit,) if isinstance(unit, str) else unit
        good = tuple(_known(one) for one in given)
        return good[0] if isinstance(unit, str) else good

    def signal(self, name: str, width: int) -> Signal:
        """As a row of the table, with at least so many columns."""
        axes = self.axes or tuple(f"{i + 1}" for i in range(width))
        units = (self.unit,) * len(axes) if isinstance(self.unit, str) else self.unit
        if len(units) != len(axes) or width > len(axes):
            came = f"{len(units)} units, {len(axes)} axes, {width} columns mapped"
            raise InvalidInputError(f"signal {name}", came, "one unit and one axis a column")
        return Signal(name, axes, units, self.role, self.frame, self.meaning)


class Channel(Part):
    """One column: value = sign * (scale * number + offset), in `unit`, then in the signal's."""

    from_: Annotated[str, Field(alias="from", min_length=1)]
    to: Annotated[str, Field(min_length=1)]
    unit: str | None = None
    sign: Annotated[int, Field(ge=-1, le=1)] = 1
    scale: float = 1.0
    offset: float = 0.0
    clock: str = MAIN
    way: Annotated[Way, named("way", list(Way))] = Way.AUTO
    frame: str | None = None

    @field_validator("unit")
    @classmethod
    def _unit_is_known(cls, unit: str | None) -> str | None:
        return None if unit is None else _known(unit)

    @model_validator(mode="after")
    def _scale_is_no_zero(self) -> Self:
        if self.sign == 0 or self.scale == 0.0:
            raise ValueError(f"{self.from_}: sign and scale must not be 0")
        return self


class FrameMap(Part):
    """Axes and origin that vectors were recorded in.

    `axes` names, for each axis of the signal's own frame, the recorded axis with its sign.
    `origin` is where a wrench was recorded about, in the signal's frame [m].
    """

    axes: tuple[Annotated[str, Field(pattern=r"^[+-]?[xyz]$")], ...]
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @field_validator("axes")
    @classmethod
    def _right_handed(cls, axes: tuple[str, ...]) -> tuple[str, ...]:
        from ves_twin.data.mapping.frames import handedness

        if len(axes) != 3 or handedness(axes) != 1:
            raise ValueError(f"axes: got {list(axes)}, expected x, y, z once each, right-handed")
        return axes


class Window(Part):
    """Stretch that is imported [s], counted from the first row of the main clock."""

    start: Annotated[Seconds, Field(ge=0)] = 0.0
    stop: Annotated[Seconds, Field(gt=0)] = 1e12


class ImportMap(Part):
    """A map: clocks, channels, frames, signals of one's own, window, rate of the rows."""

    schema_: Annotated[int, Field(alias="schema")] = SCHEMA
    clock: ClockMap
    clocks: dict[str, OtherClock] = Field(default_factory=dict)
    channel: Annotated[tuple[Channel, ...], Field(min_length=1)]
    signals: dict[str, OwnSignal] = Field(default_factory=dict)
    frames: dict[str, FrameMap] = Field(default_factory=dict)
    window: Window = Window()
    rate: Annotated[Hertz, Field(gt=0)] | None = None
    gaps: Annotated[Gaps, named("choice", list(Gaps))] = Gaps.NAN

    @model_validator(mode="after")
    def _names_are_free(self) -> Self:
        taken = sorted(set(self.signals) & set(SIGNALS))
        if taken:
            raise ValueError(f"signals: {taken[0]} is one of the rig's table, which has its unit")
        for name in self.signals:
            if not NAME.fullmatch(name):
                raise ValueError(f"signals: got {shown(name)}, expected words with points between")
        goals = [channel.to for channel in self.channel]
        twice = sorted({goal for goal in goals if goals.count(goal) > 1})
        if twice:
            raise ValueError(f"channel: two columns go to {twice[0]}")
        return self

    @staticmethod
    def load(path: str | Path) -> ImportMap:
        """A map from a TOML file.

        Raises:
            FileAccessError: missing or unreadable.
            UnknownNameError: unknown key, with the nearest one.
            InvalidInputError: wrong type, unit or range; says the key.
            VersionError: of another version of the format.
        """
        file = Path(path)
        content, _ = read_toml("map", file)
        check_schema(content, file, SCHEMA)
        try:
            return ImportMap.model_validate(content)
        except ValidationError as error:
            raise refusal(error, file.name, ImportMap) from None


def _known(unit: str) -> str:
    try:
        return check_known(spelled(unit))
    except InvalidInputError as error:
        raise ValueError(str(error)) from None
