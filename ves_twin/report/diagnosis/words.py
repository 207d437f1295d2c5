"""Words of a diagnosis: names of causes, sizes, places, what cannot be told apart."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ves_twin.core.quantity import digits, percent, quantity
from ves_twin.diagnosis.explain.rivals import Place
from ves_twin.diagnosis.record.residual_structure import Loud
from ves_twin.diagnosis.verdict.cause import Cause, Estimate
from ves_twin.diagnosis.verdict.verdict import Kind, Verdict
from ves_twin.effects.ripple import NUMBERED, Ripple

TOLD = 6
"""Names in a sentence."""


def spoken(label: str) -> str:
    """effect@target as a person says it: "Coulomb friction at leg 3"."""
    effect, _, target = label.partition("@")
    if effect == Ripple.kind and (waves := NUMBERED.fullmatch(target)):
        return f"ripple (n = {waves[2]}) at {waves[1]}"
    words = effect.replace("_", " ")
    for person in ("Coulomb", "Stribeck", "Dahl"):
        words = words.replace(person.lower(), person)
    places = target.split(".")
    if places[0] == "sensor" and len(places) == 3:  # one axis reads a share of another
        places.insert(2, "from")
    return f"{words} at {' '.join(places)}" if target else words


def name_of(cause: Cause) -> str:
    """A cause as a person says it."""
    return spoken(f"{cause.effect}@{cause.target}")


def listed(names: Sequence[str]) -> str:
    """A, B and C."""
    return " and ".join(filter(None, (", ".join(names[:-1]), names[-1])))


def fitted_word(verdict: Verdict) -> str:
    """What the fitted model of a verdict's traces is called."""
    if verdict.exhibit is None or not verdict.exhibit.causes:
        return "tolerances fitted"
    if verdict.lawful:
        return "with the law"
    if verdict.verdict is Kind.UNKNOWN:
        return "with the nearest cause"
    return "with the cause" if len(verdict.exhibit.causes) == 1 else "with the causes"


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


def interval_words(estimate: Estimate) -> str:
    """The interval of a value, as long as its digits need."""
    ends = [quantity(e, estimate.unit, _figures(estimate)) for e in (estimate.low, estimate.high)]
    (low, _, first), (_, _, second) = (end.partition(" ") for end in ends)
    if first == second:
        return f"{low} to {ends[1]}"
    return f"{ends[0]} to {ends[1]}"


def _figures(estimate: Estimate) -> int:
    """Digits that an interval needs so that its ends differ by ten of the last one at least."""
    width, size = estimate.high - estimate.low, max(abs(estimate.low), abs(estimate.high))
    if not 0.0 < width < size:
        return 3
    return int(np.clip(2 + np.ceil(np.log10(size / width)), 3, 7))


def capital(text: str) -> str:
    """With its first letter large."""
    return text[:1].upper() + text[1:]
