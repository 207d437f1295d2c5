"""Sentences of what a diagnosis cannot say, why rivals lost, and what to record next."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf

from ves_twin.core.quantity import digits, percent, quantity
from ves_twin.diagnosis.explain.rivals import Rival, Standing
from ves_twin.diagnosis.fit.tolerances import FEWEST
from ves_twin.diagnosis.verdict.verdict import Kind, Verdict
from ves_twin.report.diagnosis.strained import STRAINED, check_sentence
from ves_twin.report.diagnosis.words import TOLD, capital, ends_words, name_of, spoken

LITTLE = 0.1
"""Share of its spread that is left of each channel, up to which a model may be good enough: an arm
with 2 % of slow error, in order for its owner, left 8 % of one joint; TX40's published model 13."""

SLOW = 2.0
"""Times what is left that noise has to be declared: error that is slow counts more than noise that
is new in each row. That arm is *nothing* with 2, *unknown* with 1."""


def rival_words(rival: Rival, best: bool) -> str:
    """Why an explanation was kept or lost, and whether a range held it."""
    held = "; held by an end of its range: with a wider one it may explain more" * rival.ended
    return f"{_standing_words(rival, best)}{held}"


def _standing_words(rival: Rival, best: bool) -> str:
    if rival.standing is Standing.SCREENED:
        return (
            f"not fitted: by itself and to first order it takes {digits(rival.score)} of chi^2;"
            " beside others it may take more or less"
        )
    if best:
        return "the best"
    if rival.standing is Standing.KEPT:
        return "as good as the best"
    place = rival.place
    if place is not None:
        alone = "alone it leaves" if rival.standing is Standing.ALONE else "leaves"
        return (
            f"{alone} {digits(place.rival)} sigma in {place.channel} at {ends_words(place)},"
            f" where the best leaves {digits(place.best)}"
        )
    if rival.pull is not None and rival.pull > STRAINED:
        return f"needs a commissioning error of {rival.pull:.1f} declared tolerances"
    return "needs larger commissioning errors than the best"


def findable_sentence(verdict: Verdict) -> str:
    """What the smallest sizes mean, and what they leave out where more is wrong."""
    if not verdict.lacks:
        return (
            "A cause of this size is seen seven times out of ten by recordings like these; to be"
            " told from every other it may have to be larger."
        )
    louder = {name: one for name, one in verdict.left.items() if one.rms > one.noise > 0.0}
    ratios = {name: one.rms / one.noise for name, one in louder.items()}
    loudest = max(ratios, key=lambda name: ratios[name], default="")
    told = f" ({loudest}: {digits(ratios[loudest])} times the noise is left)" if loudest else ""
    return (
        "These sizes count noise and tolerances alone, as if the model lacked nothing else. Here it"
        f" lacks more{told}, so that a cause has to be larger to be found."
    )


def limit_sentences(verdict: Verdict) -> tuple[str, ...]:
    """What the verdict does not prove."""
    count = len(verdict.smallest_findable)
    said = [
        f"The library has {count} causes. What it lacks is never named; at best"
        " something is said to be left."
    ]
    if verdict.excluded:
        said.append(f"Not considered, as asked: {', '.join(map(spoken, verdict.excluded))}.")
    if verdict.causes and verdict.lacks:
        said.append(
            "Intervals count what is left unexplained, as far as these recordings show it. In"
            " another motion the machine may differ from the model by more."
        )
    elif verdict.causes:
        said.append(
            "Probabilities and intervals hold if the cause is in the library and the model is"
            " otherwise right; they are not probabilities that the machine is as the model says."
        )
    if verdict.causes and verdict.basis.held_out == "none":
        said.append(
            "A cause that fits these recordings may fail on others; no held-out one was given."
        )
    if verdict.basis.tolerances == "declared":
        loose = any(not cause.firm for cause in verdict.causes)
        said.append(
            "The tolerances are declared. Were they 2.5 times too small, an error of commissioning"
            " would look like a cause"
            + ("; a name called provisional may be one." if loose else ", but of a smaller size.")
        )
    if verdict.unseen:
        said.append(
            "Not recorded, or with holes all over, so nothing is known of it:"
            f" {', '.join(verdict.unseen)}."
        )
    if verdict.holes:
        told = ", ".join(f"{name} {percent(share)}" for name, share in verdict.holes.items())
        said.append(f"Rows without a value, which were left out: {told}.")
    blind = blind_causes(verdict)
    if blind:
        more = f" and {len(blind) - TOLD} more" if len(blind) > TOLD else ""
        said.append(f"Nothing can be said about {', '.join(blind[:TOLD])}{more}.")
    return (*said, *_lookalikes(verdict), *_twins(verdict))


def blind_causes(verdict: Verdict) -> list[str]:
    """Causes that these recordings would not show by themselves, but for those that are told.

    Beside others that were proved they may show: these have a size.
    """
    told = {name.partition(":")[0] for name in verdict.tuned}
    told |= {f"{cause.effect}@{cause.target}" for cause in verdict.causes}
    blind = (k for k, f in verdict.smallest_findable.items() if f.value is None)
    return [spoken(k) for k in blind if k not in told]


def _lookalikes(verdict: Verdict) -> tuple[str, ...]:
    """What each named cause could be taken for, and up to which size; the worst first.

    Of noise alone, so that it says nothing where more is left unexplained.
    """
    if verdict.lacks:
        return ()
    ranked = sorted(verdict.lookalikes, key=lambda pair: -(pair.beyond or inf))
    said = []
    for pair in ranked[:TOLD]:
        cause, other = spoken(pair.cause), spoken(pair.other)
        if pair.beyond is None:
            most = quantity(pair.largest, pair.unit)
            said.append(
                f"Recordings like these cannot tell {cause} from {other} at any size up to {most}."
            )
        else:
            size = quantity(pair.beyond, pair.unit)
            said.append(f"{capital(cause)} of less than {size} would be taken for {other}.")
    more = len(ranked) - len(said)
    return (*said, f"So for {more} more pairs (verdict.json).") if more else tuple(said)


def _twins(verdict: Verdict) -> tuple[str, ...]:
    """Look-alikes of what was named; of everything, where nothing was."""
    named = {f"{cause.effect}@{cause.target}" for cause in verdict.causes}
    pairs = [t for t in verdict.twins if not named or named & set(t[:2])][:TOLD]
    return tuple(
        f"{spoken(a)} and {spoken(b)} look alike in these recordings (cosine {cosine:.3f})."
        for a, b, cosine in pairs
    )


def _enough(verdict: Verdict) -> list[str]:
    """What to declare where what is left of every channel may be little enough for its owner."""
    shares = {n: e.after_si / e.spread for n, e in verdict.residuals.items() if e.spread > 0.0}
    if not shares or max(shares.values()) > LITTLE:
        return []
    most = max(shares, key=lambda name: shares[name])
    error = verdict.residuals[most]
    return [
        f"At most {percent(shares[most])} of a channel's spread is left. If that is good enough,"
        " declare twice what is left as noise in the machine's file"
        f" ({most}: {quantity(SLOW * error.after_si, error.unit, 2)}), and diagnose again."
    ]


def _apart(alternatives: Sequence[set[str]]) -> str:
    """What the first of several answers has that the next other one has not, and the reverse."""
    first = alternatives[0] if alternatives else set()
    other = next((names for names in alternatives if names != first), None)
    if other is None:  # the same causes at other sizes
        return " with ".join(sorted(first))
    one, two = first - other, other - first
    if not (one and two):
        one, two = first, other
    less = min(one, two, key=len) if one < two or two < one else None
    ends = [" with ".join(sorted(side)) + " alone" * (side is less) for side in (one, two)]
    return " from ".join(ends)


def next_sentences(verdict: Verdict) -> tuple[str, ...]:
    """What would make the verdict surer."""
    said = []
    if verdict.verdict is Kind.AMBIGUOUS:
        names = _apart([{name_of(verdict.causes[n]) for n in a} for a in verdict.alternatives])
        top = verdict.next_experiment[0] if verdict.next_experiment else None
        if top:
            said.append(f"To tell {names}: {top.programme}.")
        else:
            said.append(f"To tell {names}: another programme; none was offered to choose from.")
    if verdict.verdict is Kind.UNKNOWN:
        said += _enough(verdict)
        said.append(
            "Record the same programme on a machine in order, or before and after a change, and"
            " compare the two recordings (ves-twin compare --against)."
        )
    strained = check_sentence(verdict)
    if strained:
        said.append(strained)
    if verdict.causes and verdict.basis.held_out == "none":
        said.append("Record another programme on the same machine and give it as --held-out.")
    if verdict.basis.tolerances == "declared":
        said.append(
            "Narrow the tolerances of what you know better than declared, or measure them: give"
            f" {FEWEST} machines in order, or this one mounted anew {FEWEST} times, as"
            " --commissioning."
        )
    if verdict.basis.noise == "declared":
        said.append("Record the machine standing still and give it as --standstill.")
    blind = blind_causes(verdict)
    if blind:
        some = ", ".join(blind[:TOLD])
        said.append(f"Find a programme that excites what this one cannot show: {some}.")
    return tuple(said)
