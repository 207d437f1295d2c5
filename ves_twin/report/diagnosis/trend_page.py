"""trend_page: what recordings of different days say together, as one HTML page."""

from __future__ import annotations

import numpy as np

from ves_twin.core.quantity import digits, quantity
from ves_twin.diagnosis.trend.change import Change, Course
from ves_twin.diagnosis.trend.result import Answer, FollowedCause, Trend
from ves_twin.report.colours import AFTER, MEASURED
from ves_twin.report.diagnosis.trend_words import (
    trend_basis,
    trend_headline,
    trend_limits,
    trend_tone,
)
from ves_twin.report.diagnosis.words import spoken
from ves_twin.report.figure import new_figure, svg
from ves_twin.report.html import Html, bullets, paragraph, section, table
from ves_twin.report.page import html_page


def trend_page(trend: Trend, title: str = "Trend") -> str:
    """The page of a trend."""
    lead = paragraph(trend_headline(trend), f"lead {trend_tone(trend)}")
    parts: list[Html] = [lead]
    if trend.cause is not None and trend.change is not None:
        parts += [_figure(trend, trend.cause, trend.change), _sizes(trend, trend.cause)]
        if trend.cause.rivals:
            parts.append(section("Other causes, followed in the same way", _rivals(trend.cause)))
    if trend.answer is Answer.MIXED and trend.one_rig.differs:
        parts.append(section("What differs between recordings", _differs(trend)))
    parts += [
        section("On what it rests", bullets(trend_basis(trend))),
        section("Smallest change that would have been found", *_smallest(trend)),
        section("What this does not prove", bullets(trend_limits(trend))),
    ]
    return html_page(title, parts)


def _figure(trend: Trend, cause: FollowedCause, change: Change) -> Html:
    """Sizes with their intervals over the days, the course and the onset's interval."""
    days = np.array([size.day for size in trend.sizes])
    values = np.array([size.value for size in trend.sizes])
    figure = new_figure(3.6)
    axes = figure.add_subplot()
    wide = [values - [s.low for s in trend.sizes], [s.high for s in trend.sizes] - values]
    axes.errorbar(days, values, yerr=wide, fmt="none", ecolor="#c3cad1", elinewidth=1.2, capsize=3)
    own = [1.645 * size.sd for size in trend.sizes]
    axes.errorbar(days, values, yerr=own, fmt="o", color=MEASURED, markersize=4, elinewidth=2.4)
    grid = np.linspace(days[0], days[-1], 400)
    course = _course(change, grid)
    if course is not None:
        axes.plot(grid, course, color=AFTER, linewidth=1.4, zorder=0)
    if change.onset is not None:
        axes.axvspan(change.onset.low, change.onset.high, color="#f3e3d3", linewidth=0, zorder=-1)
    axes.axhline(cause.nominal, color="#9aa3ab", linewidth=0.8, linestyle=":")
    unit = "" if cause.unit == "1" else f", {cause.unit.replace('*', ' ')}"
    axes.set_ylabel(f"{cause.parameter}{unit}", fontsize=8)
    axes.set_xlabel("" if trend.calendar.first else "recording", fontsize=8)
    shown = np.unique(np.round(np.linspace(0, len(days) - 1, min(len(days), 7))).astype(int))
    axes.set_xticks(days[shown], [trend.calendar.words(days[i]) for i in shown], fontsize=7)
    axes.tick_params(axis="y", labelsize=8)
    axes.grid(color="#e8ebee", linewidth=0.6)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    caption = (
        "Size in each recording. Thick: 90 % interval against the other days; thin: with what all"
        " days share. Line: the course; shaded: when it began; dotted: nominal."
    )
    return svg(figure, "trend", caption)


def _course(change: Change, grid: np.ndarray) -> np.ndarray | None:
    before, after, onset = change.before, change.after, change.onset
    if before is None:
        return None
    if onset is None or after is None:
        return np.full(len(grid), before.value)
    if change.course is Course.STEP:
        return np.where(grid >= onset.value, after.value, before.value)
    slope = change.slope.value if change.slope else 0.0
    return np.asarray(before.value + slope * np.maximum(grid - onset.value, 0.0))


def _sizes(trend: Trend, cause: FollowedCause) -> Html:
    head = ("recording", "date", "size", "90 % interval", "sd against other days", "what is left")
    rows = [
        (
            size.recording,
            size.date,
            quantity(size.value, cause.unit),
            f"{quantity(size.low, cause.unit)} to {quantity(size.high, cause.unit)}",
            quantity(size.sd, cause.unit),
            "noise" if size.explained else f"{size.left:.1f} sigma, not noise",
        )
        for size in trend.sizes
    ]
    return section(f"{spoken(cause.label)}, day by day", table(head, rows))


def _rivals(cause: FollowedCause) -> Html:
    rows = [
        (spoken(label), digits(more, ".3g"), "as good" if label in cause.equals else "worse")
        for label, more in sorted(cause.rivals.items(), key=lambda item: item[1])
    ]
    return table(("cause", "chi^2 more than the best", ""), rows)


def _differs(trend: Trend) -> Html:
    head = ("parameter", "chi^2 of a value of its own each day", *trend.recordings)
    rows = [
        (d.parameter, digits(d.chi2), *(f"{sd:+.1f}" for sd in d.sds))
        for d in trend.one_rig.differs
    ]
    return table(
        head, rows, "in declared commissioning sd; near zero where a recording tells little"
    )


def _smallest(trend: Trend) -> list[Html]:
    known = {k: f for k, f in trend.smallest_change.items() if f.value is not None}
    blind = [spoken(k) for k, f in trend.smallest_change.items() if f.value is None]
    rows = [(spoken(label), quantity(f.value, f.unit)) for label, f in known.items()]
    note = "A step in the middle of the series, found seven times out of ten."
    parts = [paragraph(note, "note"), table(("cause", "smallest step"), rows)]
    if blind:
        parts.append(paragraph(f"Nothing can be said about: {', '.join(blind)}."))
    return parts
