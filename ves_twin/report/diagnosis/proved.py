"""proved_parts: extensions that were proved one by one, what is left, what cannot be separated."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from ves_twin.core.quantity import UNSURE, percent, quantity
from ves_twin.diagnosis.build_up.result import TOGETHER, Beyond, Left, Proved, Size
from ves_twin.diagnosis.verdict.verdict import Verdict
from ves_twin.report.diagnosis.words import spoken
from ves_twin.report.html import Html, bullets, paragraph, section, table

SHOWN = 3
"""Of channels, or what one follows, those that are told: the largest."""

NEAR = 3.0
"""Factor between a p and its limit up to which one stretch of time may turn it: the median of the
largest change where one of 11 to 40 blocks is left out (drawn, p of 0.001 to 0.02)."""

QUIET = 0.5
"""Share of its declared noise below which what is left of a channel says that this is too large."""

FEW = 4
"""Combinations that the terminal tells; the page has all."""

UNKNOWN = 100.0
"""Times that shares are known worse than their combination, from which on nothing is known."""


def proved_parts(verdict: Verdict) -> list[Html]:
    """Sections of a page; none where nothing was put to proof."""
    if verdict.put_to_proof is None:
        return []
    parts = [section("Causes that improve the prediction", *_proved(verdict))]
    if verdict.left:
        parts.append(section("What is left of each channel", *_left(verdict.left)))
    if verdict.inseparable:
        parts.append(section("What cannot be separated", bullets(inseparable_sentences(verdict))))
    return parts


def proof_sentence(verdict: Verdict) -> str:
    """How much was tried, and how sure all of it together is; empty where nothing was."""
    if verdict.put_to_proof is None:
        return ""
    rate = percent(verdict.false_discovery_rate)
    tested, better = verdict.put_to_proof, sum(not one.ended for one in verdict.proved)
    were = "cause was" if tested == 1 else "causes were"
    said = (
        f"{tested} {were} tested on held-out data; {better} of them"
        f" improve{'s' * (better == 1)} its prediction. Of such, at most {rate} are expected to be"
        " false."
    )
    if not verdict.proved:
        return said
    firm = any(one.firm for one in verdict.proved)
    names = "only firm ones are the mechanism, the others act like it" if firm else "none is firm"
    return f"{said} A better prediction does not prove a name: {names}."


def near_sentence(verdict: Verdict) -> str:
    """Which causes stand near the limit, or pass it and are worth nothing; empty without any."""
    limit = verdict.p_limit
    if limit is None:
        return ""
    proved = (one for one in verdict.proved if not one.ended)
    accepted = {one.label: one.p for one in proved if NEAR * one.p > limit}
    missed = {name: p for name, p in verdict.unproved.items() if limit < p <= NEAR * limit}
    small = [spoken(name) for name, p in verdict.unproved.items() if p <= limit]
    worth = (
        f"Hardly worth anything once all is fitted, so not kept: {', '.join(small)}."
        if small
        else ""
    )
    said = [
        f"{spoken(name)} (p {p:.2g}, {told})"
        for some, told in ((accepted, "accepted"), (missed, "not accepted"))
        for name, p in some.items()
    ]
    if not said:
        return worth
    rate = verdict.false_discovery_rate
    many = " (that high since most of them are plainly there)" if rate and limit > rate else ""
    return (
        f"Accepted is a p of {limit:.2g} at most{many}. Near it: {', '.join(said)}. Other"
        f" recordings of the same machine may turn that; longer ones settle it. {worth}".rstrip()
    )


def ended(verdict: Verdict) -> list[str]:
    """Names of the causes whose range ended the fit."""
    return [spoken(one.label) for one in verdict.proved if one.ended]


def standing_words(one: Proved) -> str:
    """How sure a name is."""
    if one.firm:
        return "firm"
    if one.ended:
        return (
            "at the end of its range, so not proved: it stands for something else, or the range is"
            " too narrow (`largest` of the effect, or `typical`)"
        )
    if one.below_row:
        return "its interval begins below a row of the log: the log's clock explains that as well"
    if one.drives:
        return _driving_words(one)
    why = next((words for holds, words in _reasons(one) if holds), "")
    if (one.acts_like or one.beyond) and not why:
        like = _or([_together(name) for name in one.acts_like])
        return f"acts like it{',' * bool(like)}{like}{_beyond_words(one.beyond)}"
    other = "what is left, a tolerance or another cause follows the same motion"
    return f"acts like it: {why or next((w for holds, w in _further(one) if holds), other)}"


def _reasons(one: Proved) -> list[tuple[bool, str]]:
    """Why it may not be the mechanism, whatever else acts like it."""
    slow, lost = "friction grows less than in proportion to speed", one.unfollowed[:SHOWN]
    return [
        (one.sublinear, f"{slow.replace('friction', 'friction that')} reads so"),
        (one.bent, f"at its place {slow}"),
        (bool(lost), f"{', '.join(lost)} is still not followed at all"),
    ]


def _further(one: Proved) -> list[tuple[bool, str]]:
    """Why not, where nothing else acts like it."""
    rests = " and ".join(map(spoken, one.rests_on))
    return [
        (bool(rests), f"it rests on {rests}, whose range ends"),
        (bool(one.spoils), f"{', '.join(one.spoils[:SHOWN])} is predicted worse with it"),
        (one.wide, "its interval reaches the end of its range"),
    ]


def _driving_words(one: Proved) -> str:
    """How sure the name of a friction is that would push its joint on."""
    if not one.standing_in:
        return (
            "acts like it, and is no friction: its joint would be pushed on by it. An effort that"
            " is read late or early (`sensor_delay` of efforts), an offset or a wrong gain reads so"
        )
    like = _or([_together(name) for name in one.acts_like if name != one.standing_in])
    return (
        f"acts like {_together(one.standing_in)}{like}; {spoken(one.effect)} of this size would"
        " push its joint on"
    )


def _or(names: Sequence[str]) -> str:
    """What else it acts like; empty where there is nothing."""
    return f" or like {' or '.join(names)}" if names else ""


def _beyond_words(others: Sequence[Beyond]) -> str:
    """Causes that do as well beyond their ranges, which are assumed; empty where there are none."""
    told = [
        f"{spoken(one.label)} "
        + ", ".join(
            f"{quantity(s.value, s.unit)} ({quantity(s.low, s.unit)} to {quantity(s.high, s.unit)})"
            for s in one.parameters.values()
        )
        for one in others
    ]
    if not told:
        return ""
    return f"; or, beyond its range, which `largest` of the effect widens, like {', '.join(told)}"


def _together(name: str) -> str:
    """A cause, or few that only together do it, as a person says it."""
    return " with ".join(map(spoken, name.split(TOGETHER)))


def proved_line(one: Proved) -> str:
    """An extension in one line of a terminal."""
    sizes = ", ".join(
        f"{quantity(s.value, s.unit)} ({_interval(s)})" for s in one.parameters.values()
    )
    return f"  {one.label:<35} {sizes}; {standing_words(one)}"


def _interval(size: Size) -> str:
    """Its ends, and what the model has where that is not zero: a place is no shift."""
    ends = f"{quantity(size.low, size.unit)} to {quantity(size.high, size.unit)}"
    model = f"; the model has {quantity(size.nominal, size.unit)}" if size.nominal else ""
    return ends + model


def inseparable_sentences(verdict: Verdict) -> list[str]:
    """Each combination by the names that take part in it."""
    told = (
        f"{', '.join(map(spoken, one.names))}: only a combination of them is known,"
        f" {_shares(one.ratio)}."
        for one in verdict.inseparable
    )
    return list(dict.fromkeys(told))


def inseparable_lines(verdict: Verdict) -> list[str]:
    """The first FEW of them for the terminal, and where the rest stands."""
    every = inseparable_sentences(verdict)
    lines = [f"not separated: {text}" for text in every[:FEW]]
    more = len(every) - len(lines)
    return [*lines, f"{more} more combinations are in report.html"] if more else lines


def _shares(ratio: float) -> str:
    """How well it is known what each of some causes has of their combination."""
    if ratio > UNKNOWN:
        return "and nothing of the share of each"
    return f"the share of each {ratio:.0f} times worse"


def _proved(verdict: Verdict) -> list[Html]:
    near = near_sentence(verdict)
    parts = [paragraph(proof_sentence(verdict)), *([paragraph(near)] if near else [])]
    if not verdict.proved:
        return parts
    head = ("cause", "size", "90 % interval", "error without and with it", "p", "name")
    rows = [row for one in verdict.proved for row in _rows(one, verdict)]
    return [*parts, table(head, rows)]


def _rows(one: Proved, verdict: Verdict) -> list[tuple[str, ...]]:
    ranked = sorted(one.takes.items(), key=lambda item: item[1][1] - item[1][0])[:SHOWN]
    takes = "; ".join(
        f"{name} {quantity(before, unit)} to {quantity(after, unit)}"
        for name, (before, after) in ranked
        for unit in [verdict.left[name].unit]
    )
    rows: list[tuple[str, ...]] = []
    for n, (name, size) in enumerate(one.parameters.items()):
        label = spoken(one.label)
        rows.append(
            (
                label if len(one.parameters) == 1 else f"{label}: {name}",
                quantity(size.value, size.unit),
                _interval(size),
                takes if n == 0 else "",
                f"{one.p:.1g}" if n == 0 else "",
                standing_words(one) if n == 0 else "",
            )
        )
    return rows


def _left(left: Mapping[str, Left]) -> list[Html]:
    head = ("channel", "before", "left", "noise", "correlation time", "goes along with", "follows")
    rows = [
        (
            name,
            quantity(one.before, one.unit),
            quantity(one.rms, one.unit),
            quantity(one.noise, one.unit),
            quantity(one.memory, "s"),
            _largest(one.along, "{:+.2f}".format),
            _largest(one.laws, percent),
        )
        for name, one in left.items()
    ]
    note = (
        "Rms on held-out data. What is left beyond noise is model error: no cause of the library"
        " explains it. Follows: a smooth law of that signal would take this share of its square."
    )
    quiet = [name for name, one in left.items() if one.rms < QUIET * one.noise]
    said = f"{', '.join(quiet)}: less is left than the noise that is declared, which is too large."
    return [paragraph(note, "note"), table(head, rows), *[paragraph(said)] * bool(quiet)]


def _largest(found: Mapping[str, float], told: Callable[[float], str]) -> str:
    """The largest few, and how many more: what is left may follow a dozen signals alike."""
    ranked = sorted(found.items(), key=lambda item: -abs(item[1]))
    more = f" and {len(ranked) - SHOWN} more" if len(ranked) > SHOWN else ""
    return ", ".join(f"{name} ({told(size)})" for name, size in ranked[:SHOWN]) + more or UNSURE
