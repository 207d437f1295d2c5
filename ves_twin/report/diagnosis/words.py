"""Sentences of a diagnosis: verdict, sizes, basis, gain; never surer than the verdict's basis."""

from __future__ import annotations

import numpy as np

from ves_twin.core.quantity import digits, percent, quantity, shares
from ves_twin.diagnosis.disagreement import disagree
from ves_twin.diagnosis.residual_structure import Loud
from ves_twin.diagnosis.rivals import Place
from ves_twin.diagnosis.tolerances import FEWEST
from ves_twin.diagnosis.verdict import Cause, Estimate, Kind, Verdict

STRANGER = 0.5
"""Share of a channel's own spread that stays unexplained where the plant is hardly this one."""

TOLD = 6
"""Names in a sentence."""


def spoken(label: str) -> str:
    """effect@target as a person says it: "Coulomb friction at leg 3"."""
    effect, _, target = label.partition("@")
    words = effect.replace("_", " ").replace("coulomb", "Coulomb")
    places = target.split(".")
    if places[0] == "sensor" and len(places) == 3:  # one axis reads a share of another
        places.insert(2, "from")
    return f"{words} at {' '.join(places)}" if target else words


def name_of(cause: Cause) -> str:
    """A cause as a person says it."""
    return spoken(f"{cause.effect}@{cause.target}")


def headline(verdict: Verdict) -> str:
    """The verdict in a sentence or two."""
    names = [name_of(cause) for cause in verdict.causes]
    match verdict.verdict:
        case Kind.NOTHING:
            return _nothing(verdict)
        case Kind.UNKNOWN:
            return _unknown(verdict)
        case _ if verdict.proved:
            return _proved(verdict)
        case Kind.AMBIGUOUS | Kind.PARTIAL:
            return verdict.naming(names) + _doubt(verdict)
        case _:
            return verdict.naming(names, _begin(verdict)) + _doubt(verdict)


def tone(verdict: Verdict) -> str:
    """Style of the headline: good, bad, or open where more has to be known."""
    if verdict.verdict is Kind.NOTHING:
        blind = [f for f in verdict.smallest_findable.values() if f.value is None]
        return "open" if blind or verdict.unseen else "good"
    settled = verdict.verdict in (Kind.NAMED, Kind.SEVERAL)
    proven = verdict.gain is not None and verdict.gain.passed
    return "bad" if settled and proven and all(c.firm for c in verdict.causes) else "open"


def _nothing(verdict: Verdict) -> str:
    lost = sum(f.value is None for f in verdict.smallest_findable.values())
    count = len(verdict.smallest_findable)
    said = "Nothing found: what is off lies within noise and commissioning tolerances."
    if lost == count and count:
        return f"Nothing can be said: this recording would show none of the {count} causes."
    if lost:
        return f"{said} About {lost} of {count} causes this recording can say nothing."
    return f"{said} Each of the {count} causes would have shown from the size listed below on."


def _unknown(verdict: Verdict) -> str:
    strange = strangers(verdict)
    if strange and not disagree(verdict.alone):
        names = ", ".join(strange[:TOLD])
        return (
            "Something is wrong that no cause in the library explains, and the recording hardly"
            f" looks like one of this plant: most of {names} stays unexplained."
        )
    if disagree(verdict.alone):
        return (
            "These recordings do not agree. Each alone is in order or has one cause, but nothing"
            " explains all of them."
        )
    if verdict.law is not None and verdict.law.claimed:
        return f"No cause in the library explains it. A law does: {verdict.law.words}."
    return "Something is wrong that no cause in the library explains."


def _proved(verdict: Verdict) -> str:
    """Of causes that were proved one by one: firm names, those that act like one, what is left."""
    firm = [spoken(one.label) for one in verdict.proved if one.firm]
    like = [spoken(one.label) for one in verdict.proved if not one.firm]
    count = len(verdict.proved)
    what = "1 extension predicts" if count == 1 else f"{count} extensions predict"
    said = f"{what} held-out data better, each beside all others."
    for begin, names in (("Firm", firm), ("Acting like", like)):
        more = f" and {len(names) - TOLD} more" if len(names) > TOLD else ""
        said += f" {begin}: {', '.join(names[:TOLD])}{more}." if names else ""
    if verdict.verdict is Kind.PARTIAL:
        said += " Something more stays unexplained."
    return said


def _begin(verdict: Verdict) -> str:
    proven = verdict.gain is not None and verdict.gain.passed
    return "Found:" if proven and all(c.firm for c in verdict.causes) else "Best explained by"


def _doubt(verdict: Verdict) -> str:
    loose = [cause for cause in verdict.causes if not cause.firm]
    if verdict.unconfirmed and verdict.gain is not None:
        if not verdict.gain.by_causes:
            return " The held-out recordings are explained better without it."
        return " The held-out recordings do not confirm it."
    if loose:
        most = max(cause.sigmas or 0.0 for cause in loose)
        which = "It is" if len(verdict.causes) == 1 else f"{name_of(loose[0])} is"
        which = "Each is" if len(loose) == len(verdict.causes) > 1 else capital(which)
        upto = "up to " if len(loose) > 1 else ""
        if verdict.basis.baseline == "measured":
            return (
                f" {which} off by {upto}{most:.1f} times what a rig in order may change by"
                " since its baseline: a fault, or a change that large."
            )
        return (
            f" {which} {upto}{most:.1f} declared tolerances off: a fault, or an error of"
            " commissioning that large."
        )
    if verdict.basis.held_out == "none":
        it = "Each" if verdict.verdict is Kind.AMBIGUOUS else "It"
        return f" {it} fits these recordings; no other recording has tested it."
    if verdict.gain is None or verdict.gain.share is None:
        return " The held-out recordings can neither confirm nor refute it."
    return " Held-out recordings confirm it."


def fitted_word(verdict: Verdict) -> str:
    """What the fitted model of a verdict's traces is called."""
    if verdict.exhibit is None or not verdict.exhibit.causes:
        return "tolerances fitted"
    return "nearest cause" if verdict.verdict is Kind.UNKNOWN else "extended"


def nearest_sentence(verdict: Verdict) -> str:
    """What comes nearest where nothing in the library explains the record; else empty."""
    left = verdict.leftover
    if verdict.verdict is not Kind.UNKNOWN or left is None or disagree(verdict.alone):
        return ""
    said = ""
    if verdict.suspect:
        names = " with ".join(map(spoken, verdict.suspect.split(" with ")))
        said = f"Nearest, and not accepted: {names}. "
        if verdict.gain is not None and verdict.gain.share is not None and verdict.gain.passed:
            share = shares(verdict.gain.share)[0]
            said += f"It takes {share} of the held-out error away, and more is missing. "
    if left.loud:
        top = left.loud[0]
        said += f"What is left is loudest in {top.channel} at {ends_words(top)}."
    return said


def ambiguity_sentences(verdict: Verdict) -> tuple[str, ...]:
    """What cannot be told from what, with the figures; none unless the verdict is ambiguous."""
    if verdict.verdict is not Kind.AMBIGUOUS:
        return ()
    groups = [[verdict.causes[i] for i in numbers] for numbers in verdict.alternatives]
    names = [" with ".join(map(name_of, group)) for group in groups]
    kept = [rival.behind for rival in verdict.rivals[: len(groups)]]
    first, asked = groups[0][0].probability, verdict.statistics.naming_odds
    said = []
    for name, group, behind in zip(names[1:], groups[1:], kept[1:], strict=False):
        figures = [f"odds {first / max(group[0].probability, 1e-9):.2g} to 1"]
        if asked:
            figures.append(f"{asked:g} to 1 would settle it")
        if behind:
            figures.append(f"its best fit leaves {digits(behind, '.2g')} more of chi^2")
        said.append(f"Cannot tell {names[0]} from {name}: {', '.join(figures)}.")
    return tuple(said)


def ends_words(place: Loud | Place) -> str:
    """A band or a stretch of time."""
    unit = "Hz" if place.kind == "band" else "s"
    low, high = f"{place.low:.3g}", f"{place.high:.3g}"
    return f"{low} {unit}" if low == high else f"{low} to {high} {unit}"


def alone_sentences(verdict: Verdict) -> tuple[str, ...]:
    """What each recording says by itself, where all together have no explanation."""
    told = []
    for one in verdict.alone:
        said = "nothing is wrong"
        if one.causes:
            sizes = ", ".join(quantity(size, unit) for size, unit in one.sizes)
            said = f"{' or '.join(map(spoken, one.causes))}, {sizes}"
        if not one.explained:
            said = f"no single cause explains it; nearest is {said}"
        told.append(f"{one.recording} alone: {said}.")
    return tuple(told)


def strangers(verdict: Verdict) -> list[str]:
    """Channels of which the best explanation leaves more than half of their own movement."""
    return [
        name
        for name, error in verdict.residuals.items()
        if error.after > 10.0 and error.after_si > STRANGER * error.spread
    ]


def size_words(estimate: Estimate, origin: str = "nominal") -> str:
    """Size of a departure: "12.4 mN m", or "1.04 kg, 39 g above nominal"."""
    value = quantity(estimate.value, estimate.unit, _figures(estimate))
    if estimate.nominal == 0.0:
        return value
    change = estimate.value - estimate.nominal
    if estimate.unit == "1":
        part = percent(abs(change / estimate.nominal))
    else:
        part = quantity(abs(change), estimate.unit)
    return f"{value}, {part} {'above' if change > 0.0 else 'below'} {origin}"


def interval_words(estimate: Estimate, origin: str = "nominal") -> str:
    """The interval of a size, as long as its digits need."""
    low, high = estimate.low, estimate.high
    if estimate.nominal and estimate.unit != "1":
        there = [quantity(end - estimate.nominal, estimate.unit) for end in (low, high)]
        return f"{there[0]} to {there[1]} from {origin}"
    ends = [quantity(end, estimate.unit, _figures(estimate)) for end in (low, high)]
    return f"{ends[0]} to {ends[1]}"


def _figures(estimate: Estimate) -> int:
    """Digits that an interval needs so that its ends differ by ten of the last one at least."""
    width, size = estimate.high - estimate.low, max(abs(estimate.low), abs(estimate.high))
    if not 0.0 < width < size:
        return 3
    return int(np.clip(2 + np.ceil(np.log10(size / width)), 3, 7))


def gain_sentence(verdict: Verdict) -> str:
    """What the extension is worth on recordings it has not seen."""
    gain = verdict.gain
    if gain is None:
        if not verdict.causes:
            return ""
        return (
            "Gain: not known. No held-out recording was given, so nothing shows that the extended"
            " plant predicts better than the nominal one."
        )
    if gain.share is None:
        return (
            "Gain: the held-out recordings show no error beyond noise that an extension could take"
            " away; they neither confirm nor refute it."
        )
    share, low, high = shares(gain.share, gain.low, gain.high)
    span = f"{low} to {high}"
    said = f"{share} of the error beyond noise on held-out recordings ({span})"
    if gain.passed:
        return f"Gain: the extended plant takes away {said}."
    if not gain.by_causes:
        return f"Gain: {said}. But the same rig without the cause predicts them better."
    return f"Gain: {said}. That is no clear gain."


def basis_sentences(verdict: Verdict) -> tuple[str, ...]:
    """On what the verdict rests, in plain words."""
    basis, limit = verdict.basis, verdict.statistics.naming_limit
    noise = {
        "measured": "Noise: measured at a standstill.",
        "declared": "Noise: as the plant's numbers declare it; no standstill recording was given.",
    }
    unit = "declared tolerances off"
    if basis.baseline == "measured":
        unit = "times as far off as a rig in order may change since its baseline"
    beyond = f" A fault is what is {limit:.1f} {unit}." if limit else ""
    scale = verdict.statistics.tolerance_scale or 0.0
    tolerances = {
        "measured": "Tolerances: measured on commissioning recordings,"
        f" {scale:.2g} times the declared ones.{beyond}",
        "declared": "Tolerances: declared, not measured; they may be too small. With"
        f" {FEWEST} commissioning recordings they would be measured.{beyond}",
    }
    held = {
        "measured": "Held-out recordings: given.",
        "split": "Held-out recordings: none were given. The record was cut into stretches, and"
        " every second one was held out.",
        "none": "Held-out recordings: none. The verdict was not tested on other data.",
    }
    return (
        noise.get(basis.noise, f"Noise: {basis.noise}."),
        tolerances.get(basis.tolerances, f"Tolerances: {basis.tolerances}."),
        held.get(basis.held_out, f"Held-out recordings: {basis.held_out}."),
    )


def capital(text: str) -> str:
    """With its first letter large."""
    return text[:1].upper() + text[1:]
