"""ClockReport: rate, gaps, repeats and steps back of a time column, counted piece by piece."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ves_twin.core.types import FloatArray

GAP = 1.5
"""A step longer than so many periods is a gap."""

UNEVEN = 0.05
"""Share of the steps from which long ones are no gaps: rows come as they come, and none is lost."""

LISTED = 5
"""Gaps that are told one by one: the longest."""


@dataclass(frozen=True)
class Gap:
    """A hole in a clock: where it begins and how long it is [s]."""

    start: float
    length: float


@dataclass(frozen=True)
class ClockReport:
    """What a time column is like.

    Attributes:
        column: its name.
        unit: of the file's numbers.
        guessed: the unit is a guess, the file does not say it.
        start, stop: first and last time [s].
        rows: that hold a time.
        period: usual step of its begin [s].
        jitter: largest deviation of a step that is no gap, in periods.
        gaps: number of steps longer than 1.5 periods.
        longest: the longest of them.
        repeats: rows with the time of the row before.
        back: rows with an earlier time than the row before.
        missing: rows without a time.
    """

    column: str
    unit: str
    guessed: bool
    start: float
    stop: float
    rows: int
    period: float
    jitter: float
    gaps: int
    longest: tuple[Gap, ...]
    repeats: int
    back: int
    missing: int

    @property
    def rate(self) -> float:
        """Rows a second by the median step [Hz]; 0 where there is none."""
        return 1.0 / self.period if self.period > 0.0 else 0.0

    @property
    def uneven(self) -> bool:
        """Whether long steps are so many that they are how the rows come, not gaps."""
        return self.gaps > UNEVEN * self.rows


_COUNTS = ("gaps", "repeats", "back")


@dataclass
class ClockCounter:
    """Takes a time column piece by piece.

    Attributes:
        column: its name.
        unit: of its numbers.
        guessed: the unit is a guess.
        scale: of the unit [s].
    """

    column: str
    unit: str
    guessed: bool
    scale: float
    _last: float = np.nan
    _first: float = np.nan
    _rows: int = 0
    _missing: int = 0
    _period: float = 0.0
    _longest: float = 0.0
    _jitter: float = 0.0
    _gaps: list[Gap] = field(default_factory=list)
    _counts: dict[str, int] = field(default_factory=lambda: dict.fromkeys(_COUNTS, 0))

    def take(self, raw: FloatArray) -> None:
        """The next rows (n,), in the file's unit."""
        good = np.isfinite(raw)
        self._missing += int(np.count_nonzero(~good))
        time = raw[good] * self.scale
        if not len(time):
            return
        if self._rows == 0:
            self._first = float(time[0])
            self._period = usual_step(time)
            self._longest = longest_step(np.diff(time), self._period)
        steps = np.diff(time, prepend=self._last if self._rows else time[0])
        if self._rows == 0:
            steps = steps[1:]
        self._count(steps, time)
        self._rows += len(time)
        self._last = float(time[-1])

    def _count(self, steps: FloatArray, time: FloatArray) -> None:
        self._counts["repeats"] += int(np.count_nonzero(steps == 0.0))
        self._counts["back"] += int(np.count_nonzero(steps < 0.0))
        if self._period <= 0.0 or not len(steps):
            return
        wide = np.flatnonzero(steps > self._longest)
        self._counts["gaps"] += len(wide)
        before = time[len(time) - len(steps) :][wide] - steps[wide]
        self._gaps += [
            Gap(float(a), float(b)) for a, b in zip(before[:1000], steps[wide][:1000], strict=True)
        ]
        self._gaps = sorted(self._gaps, key=lambda gap: -gap.length)[:LISTED]
        even = steps[(steps > 0.0) & (steps <= self._longest)]
        if len(even):
            off = float(np.max(np.abs(even - self._period))) / self._period
            self._jitter = max(self._jitter, off)

    def report(self) -> ClockReport:
        """What was counted."""
        return ClockReport(
            column=self.column,
            unit=self.unit,
            guessed=self.guessed,
            start=self._first,
            stop=self._last,
            rows=self._rows,
            period=self._period,
            jitter=self._jitter,
            longest=tuple(self._gaps),
            missing=self._missing,
            **self._counts,
        )


COUNTS = (1e-2, 1e-3, 1e-6)
"""Seconds that stamps are written in whole ones of, hundredths to microseconds."""

WHOLE, MOST = 0.01, 0.99
"""Part of a count by which a step may miss a whole one (digits of a double in a date), and share of
the steps that must be whole."""

STRETCH, APART = 50, 4.0
"""Steps of a stretch, and counts by which nine of ten such stretches differ at most: rows that are
lost now and then make it longer, rounding does not."""


def rounding(steps: FloatArray) -> float:
    """Seconds by which steps of stamps in whole counts may differ [s]; 0 where they do not.

    Rows at 420 Hz are 2 or 3 ms apart in whole ones: neither is their step, and none is a gap.

    Args:
        steps: between stamps (n,) [s].
    """
    steps = steps[steps > 0.0]
    if not len(steps):
        return 0.0
    median = float(np.median(steps))
    for count in COUNTS:
        whole = steps / count
        if np.mean(np.abs(whole - np.round(whole)) < WHOLE) > MOST:
            beside = np.round(np.abs(steps - median) / count) == 1.0
            length = min(STRETCH, max(len(steps) // 4, 1))
            sums = np.convolve(np.minimum(whole, np.round(median / count) + 2.0), np.ones(length))
            low, high = np.percentile(sums[length - 1 : len(steps)], (5.0, 95.0))
            return count if np.mean(beside) > UNEVEN and high - low <= APART else 0.0
    return 0.0


def longest_step(steps: FloatArray, period: float) -> float:
    """The step of rows a period apart beyond which one is missing [s].

    Args:
        steps: between stamps (n,) [s].
        period: the usual one of them [s].
    """
    return GAP * period + rounding(steps)


def usual_step(time: FloatArray) -> float:
    """Mean of the steps near the median one [s]; 0 where no step goes forward.

    Stamps that count whole milliseconds have a median step that is off by up to half of one.
    """
    steps = np.diff(time)
    steps = steps[steps > 0.0]
    if not len(steps):
        return 0.0
    median = float(np.median(steps))
    far = max((GAP - 1.0) * median, (1.0 + WHOLE) * rounding(steps))
    near = steps[np.abs(steps - median) < far]
    return float(np.mean(near)) if len(near) else median
