"""law_heading, law_parts, law_sentences: a law in words and as a picture, with what it rests on."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from ves_twin.core.quantity import digits, quantity
from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.law.result import LawFinding, LawRival
from ves_twin.report.colours import AFTER, MEASURED
from ves_twin.report.diagnosis.basis import rms_words, taken_words
from ves_twin.report.diagnosis.words import capital, listed
from ves_twin.report.figure import new_figure, svg
from ves_twin.report.html import Html, bullets, folded, paragraph, table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

EQUAL = 3.0
"""Nats within which another law is as good: odds below 20."""


BEYOND_DOUBT = 1000.0
"""Nats from which more of them tell nobody anything."""

WORTH_A_LOOK = 0.1
"""Share of the held-out error from which the page sends its reader to a law that is not claimed."""

AHEAD = ", at positive speed; at negative speed it is turned round"
"""Of a picture of dry friction that depends on position."""

DRAWN = 400
"""Places at which a law is drawn, from end to end of what was seen."""


def law_sentences(law: LawFinding, out: Sequence[str] = ()) -> list[str]:
    """What was found, what it is worth, where it was seen, what else it could be.

    Of a law that is not claimed, and not worth a look, the first alone.

    Args:
        law: that was found.
        out: names of the causes beside it whose range ended.
    """
    said = [capital(f"{law.words}.") if law.claimed else _missing(law)]
    if not (law.claimed or _likely(law)):
        return said
    said.append(worth_sentence(law))
    if law.seen:
        spans = [
            f"{name} from {quantity(low, unit)} to {quantity(high, unit)}"
            for name, (low, high), unit in zip(law.of, law.seen, law.units, strict=False)
        ]
        said.append(f"Seen: {'; '.join(spans)}. Beyond that it is held, and was never measured.")
    if law.form and len(law.of) == 1:
        unit = law.units[0].replace("*", " ") or "units of the command"
        said.append(
            f"In the formula x is {law.of[0]} in {unit}, the {law.kind} is in {_unit(law)}."
        )
    if law.transient:
        said.append("It depends on time: it holds for these recordings, and foretells nothing.")
    if out:
        said.append(
            f"Beside it the range of {listed(out)} ended: it may stand for the rest of that."
        )
    said.append(_else(law))
    return said


def _unit(law: LawFinding) -> str:
    return law.units[-1].replace("*", " ")


def _missing(law: LawFinding) -> str:
    advice = ": look there first" if _likely(law) else ""
    return (
        f"No law is claimed: {law.reason}. What comes nearest is {law.words or law.place}{advice}."
    )


def _likely(law: LawFinding) -> bool:
    """Whether held-out recordings leave a law that is not claimed worth a look."""
    gain = law.gain
    return gain is None or gain.share is None or (gain.share >= WORTH_A_LOOK and not gain.grown)


def worth_sentence(law: LawFinding) -> str:
    """What a law is worth, on held-out recordings and by odds."""
    nats = f"{law.nats:.0f}" if law.nats < BEYOND_DOUBT else f"over {BEYOND_DOUBT:.0f}"
    odds = f"{nats} nats more probable than no law"
    gain = law.gain
    if gain is None:
        return f"It is {odds}. No held-out recording has tried it."
    if gain.share is None:
        return f"It is {odds}. The held-out recordings show nothing that it could improve."
    beside = f"; over the causes alone {rms_words(gain)}" if law.part and gain.errors else ""
    return f"It takes away {taken_words(gain)}, and is {odds}{beside}."


def equals(law: LawFinding) -> list[LawRival]:
    """Other laws that are as good: leave noise if it does, and are no less probable than that."""
    needed = law.misfit <= law.misfit_limit
    return [one for one in law.also if (one.adequate or not needed) and one.behind < EQUAL]


def _else(law: LawFinding) -> str:
    other = [one.form or one.label for one in equals(law)]
    if other:
        return f"As good, within {EQUAL:.0f} nats: {'; '.join(other)}."
    return f"No other law that was tried comes within {EQUAL:.0f} nats."


def law_heading(law: LawFinding) -> str:
    """Of the section: no law stands above a place where one is only missing."""
    if not law.claimed:
        return "Where a law is missing"
    return "A law of what the causes leave" if law.part else "A law in place of a cause"


def law_parts(law: LawFinding, out: Sequence[str] = ()) -> list[Html]:
    """The section of a report; arguments as of `law_sentences`."""
    lines = law_sentences(law, out)
    parts = [paragraph(lines[0], "lead open" if law.claimed else "")]
    parts += [bullets(lines[1:])] if lines[1:] else []
    if law.curve is not None:
        parts.append(law_figure(law))
    if law.numbers:
        rows = [
            (one.name, digits(one.value), f"{digits(one.low)} to {digits(one.high)}")
            for one in law.numbers
        ]
        parts.append(table(("number", "value", "90 % interval"), rows))
    if law.also:
        others = [
            (one.label, one.form, digits(one.behind), "yes" if one.adequate else "no")
            for one in law.also
        ]
        head = ("law", "formula", "less probable, nats (below 0: more)", "leaves noise")
        parts.append(folded("What else was fitted", table(head, others)))
    return parts


def law_figure(law: LawFinding) -> Html:
    """The picture of a law in a page."""
    points = " Points: what the recordings ask for along time, without any law."
    against = " It acts beside the drive, which must give as much against it."
    caption = (
        f"{capital(law.kind)} at {law.place} against {law.of[0]}.{points if law.points else ''}"
        f" Line and band: the law{AHEAD * (len(law.of) > 1)}.{against * (law.kind == 'effort')}"
    )
    return svg(draw_law(law), "law", caption)


def draw_law(law: LawFinding, truth: Callable[[FloatArray], FloatArray] | None = None) -> Figure:
    """A law against its variable, its band, and what the recordings ask for.

    Args:
        law: one that has a curve.
        truth: the law itself, where somebody knows it.
    """
    if law.curve is None:
        raise TypeError(f"{law.words} has no curve")
    figure = new_figure(3.6)
    axes = figure.subplots()
    low, high = law.seen[0]
    x = np.linspace(low, high, DRAWN)
    if law.points:
        at, value, sd = (np.array(rows) for rows in law.points)
        axes.errorbar(
            at, value, 1.645 * sd, fmt="o", ms=3, lw=0.7, color=MEASURED, label="recordings"
        )
    if law.band:
        along, least, most = law.band
        axes.fill_between(
            along, least, most, color=AFTER, alpha=0.25, linewidth=0, label="90 % band"
        )
    places, values = (np.array(rows, float) for rows in law.curve)
    found = np.interp(x, places, values)
    axes.plot(x, found, color=AFTER, lw=1.4, label="law")
    if truth is not None:
        axes.plot(x, truth(x), "--", color="black", lw=1.0, label="truth")
    axes.set_xlabel(f"{law.of[0]}, {law.units[0].replace('*', ' ')}".rstrip(", "), fontsize=8)
    ahead = " at positive speed" * (len(law.of) > 1)
    axes.set_ylabel(f"{law.kind} at {law.place}{ahead}, {_unit(law)}", fontsize=8)
    axes.tick_params(labelsize=8)
    axes.grid(color="#e8ebee", linewidth=0.6)
    axes.legend(fontsize=7, frameon=False)
    return figure
