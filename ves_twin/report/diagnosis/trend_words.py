"""Sentences of a trend: what changed, since when, and how often such a sentence is wrong."""

from __future__ import annotations

from ves_twin.core.quantity import percent, quantity
from ves_twin.diagnosis.trend.change import DOUBT, Change, Interval
from ves_twin.diagnosis.trend.result import Answer, FollowedCause, Trend
from ves_twin.report.diagnosis.words import TOLD, spoken


def trend_headline(trend: Trend) -> str:
    """The answer in a sentence or two."""
    cause, change = trend.cause, trend.change
    if cause is None or change is None or trend.answer in (Answer.NOTHING, Answer.MIXED):
        return _rig(trend)
    name, unit = spoken(cause.label), cause.unit
    match trend.answer:
        case Answer.UNKNOWN:
            return _unknown(trend, name)
        case Answer.CONSTANT:
            size = _size(change.before, cause)
            return f"{name}: {size}, constant since the first day.{_doubt(trend)}"
        case Answer.VARIES:
            return (
                f"{name} differs from recording to recording by {quantity(change.scatter, unit)}"
                f" (sd) about {_size(change.before, cause)}, without a step or a trend that"
                f" {_rate(trend)} of unchanged machines would not show.{_doubt(trend)}"
            )
        case _:
            return f"{_changed(trend, cause, change)}{_doubt(trend)}"


def trend_tone(trend: Trend) -> str:
    """Style of the headline."""
    if trend.answer is Answer.NOTHING:
        return "good"
    settled = trend.answer in (Answer.CONSTANT, Answer.STEP, Answer.RAMP)
    certain = trend.cause is not None and trend.cause.firm and not trend.cause.equals
    return "bad" if settled and certain else "open"


def _rig(trend: Trend) -> str:
    count, (first, last) = len(trend.recordings), _ends(trend)
    if trend.answer is Answer.NOTHING:
        return f"Nothing found: no cause and no change in {count} recordings, {first} to {last}."
    said = (
        "These recordings are not of one machine in one state: each alone is explained, all"
        " together are not."
    )
    if not trend.one_rig.differs:
        return said
    top, groups = trend.one_rig.differs[0], trend.one_rig.groups
    names = [", ".join(_short([trend.recordings[i] for i in group])) for group in groups]
    return f"{said} Most apart is {top.parameter}: {names[0]} against {names[1]}."


def _short(names: list[str]) -> list[str]:
    return names if len(names) <= TOLD else [*names[:TOLD], f"{len(names) - TOLD} more"]


def _unknown(trend: Trend, name: str) -> str:
    named = ", ".join(_short(list(trend.unexplained)))
    return (
        f"In {len(trend.unexplained)} of {len(trend.recordings)} recordings something is wrong that"
        f" no single cause in the library explains: {named}. Nearest, and not accepted: {name}."
    )


def _changed(trend: Trend, cause: FollowedCause, change: Change) -> str:
    name, say, onset = spoken(cause.label), trend.calendar.words, change.onset
    if onset is None:
        return ""
    if trend.answer is Answer.STEP:
        when = f"between {say(onset.low)} and {say(onset.high)}"
        if len({say(onset.value), say(onset.high)}) > 1:
            when += f", most probably first seen on {say(onset.value)}"
        return (
            f"{name} changed {when}: from {_size(change.before, cause)} to"
            f" {_size(change.after, cause)}."
        )
    slope = change.slope or Interval(0.0, 0.0, 0.0)
    began = f"since {say(onset.value)} ({say(onset.low)} to {say(onset.high)})"
    if onset.low <= min(trend.calendar.days):
        began = f"since the first recording or before (at the latest {say(onset.high)})"
    ends = [quantity(end, cause.unit) for end in (slope.low, slope.high)]
    return (
        f"{name} changes steadily {began}, by {quantity(slope.value, cause.unit)}"
        f" ({ends[0]} to {ends[1]}) a {trend.calendar.unit}: from {_size(change.before, cause)}"
        f" to {_size(change.after, cause)} at the end."
    )


def _size(size: Interval | None, cause: FollowedCause) -> str:
    """A value with its interval, or that it cannot be told from none."""
    if size is None:
        return ""
    low, high = (quantity(end, cause.unit) for end in (size.low, size.high))
    if cause.nominal == 0.0 and size.low <= 0.0 <= size.high:
        return f"none that shows ({low} to {high})"
    return f"{quantity(size.value, cause.unit)} ({low} to {high})"


def _doubt(trend: Trend) -> str:
    cause, change = trend.cause, trend.change
    said = ""
    if cause is not None and cause.equals:
        names = " or ".join(map(spoken, cause.equals[:TOLD]))
        said += f" These recordings cannot tell it from {names}."
    if trend.unexplained:
        days = ", ".join(_short(list(trend.unexplained)))
        said += (
            f" In {days} something more is wrong: that day tells nothing of the course, and the"
            " library may lack what is at work."
        )
    elif cause is not None and not cause.firm:
        off = f"{cause.sigmas or 0.0:.1f} declared tolerances"
        said += f" It is {off} off: a fault, or an error of commissioning that large."
    if change is not None and change.other > DOUBT and change.onset is not None:
        other = "ramp" if trend.answer is Answer.STEP else "step"
        said += f" It may be a {other} instead (probability {percent(change.other)})."
    return said


def _rate(trend: Trend) -> str:
    return percent(trend.false_alarm)


def _ends(trend: Trend) -> tuple[str, str]:
    days = trend.calendar.days
    return trend.calendar.words(min(days)), trend.calendar.words(max(days))


def trend_basis(trend: Trend) -> tuple[str, ...]:
    """On what the answer rests."""
    s, rig, change = trend.statistics, trend.one_rig, trend.change
    said = [
        f"False alarms: {_rate(trend)} of the machines on which nothing changes are said to have"
        " changed, whatever cause and date; as many in order are given a constant cause, as many"
        " single machines are taken for several, and as many called unexplained.",
        f"Best change in the library: chi^2 {s.change:.3g}, limit {s.change_limit:.3g}; sizes of"
        f" each day {s.varies:.3g}, limit {s.varies_limit:.3g}; constant size {s.constant:.3g},"
        f" limit {s.constant_limit:.3g}.",
        f"One machine: chi^2 {rig.statistic:.3g}, limit {rig.threshold:.3g}.",
        "Noise: measured at a standstill."
        if trend.basis.noise == "measured"
        else "Noise: as the plant's numbers declare it, level and colour corrected by each record.",
    ]
    if trend.calendar.first is None:
        said.append("No dates in the names: recordings are numbered in order and count as even.")
    if change is not None and change.permutation is not None and trend.cause is not None:
        said.append(
            f"Sizes scatter by {quantity(change.scatter, trend.cause.unit)} from day to day beyond"
            f" their intervals; {percent(change.permutation)} of the shuffled orders of the days"
            " have a change as good."
        )
    if trend.unexplained and trend.answer is not Answer.UNKNOWN:
        said.append(f"Not explained: {', '.join(trend.unexplained)}.")
    return tuple(said)


def trend_limits(trend: Trend) -> tuple[str, ...]:
    """What the answer does not prove."""
    said = [
        "One cause is followed. Where two change, the recordings are called unexplained or of"
        " several machines.",
        "A cause that the library lacks is never named.",
        "Rates and intervals hold if the model is otherwise right and days differ only by their own"
        " start, zero and noise errors.",
    ]
    if trend.not_followed:
        names = ", ".join(map(spoken, trend.not_followed[:TOLD]))
        said.append(
            f"Not followed, since they have more than one number or a shape in time: {names}."
        )
    if trend.excluded:
        said.append(f"Not considered, as asked: {', '.join(map(spoken, trend.excluded))}.")
    return tuple(said)
