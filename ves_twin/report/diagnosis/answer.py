"""headline: a diagnosis in three sentences: what was found, how sure it is, what to do next."""

from __future__ import annotations

from ves_twin.core.quantity import percent
from ves_twin.diagnosis.build_up.result import TOGETHER, UNFINISHED, is_sublinear
from ves_twin.diagnosis.explain.disagreement import disagree
from ves_twin.diagnosis.law.result import LAW
from ves_twin.diagnosis.unseen.gain import Gain
from ves_twin.diagnosis.verdict.cause import Cause
from ves_twin.diagnosis.verdict.verdict import Kind, Verdict
from ves_twin.report.diagnosis.basis import gain_words, taken_share
from ves_twin.report.diagnosis.coarse_step import finer
from ves_twin.report.diagnosis.law import worth_sentence
from ves_twin.report.diagnosis.limits import next_sentences
from ves_twin.report.diagnosis.out_of_step import shorter
from ves_twin.report.diagnosis.proved import ended
from ves_twin.report.diagnosis.strained import check_sentence, strained_sentence
from ves_twin.report.diagnosis.words import (
    TOLD,
    capital,
    ends_words,
    listed,
    name_of,
    size_words,
    spoken,
)

STRANGER = 0.5
"""Share of a channel's own spread that stays unexplained where the model is hardly this machine."""

AGAIN = (
    " Held-out recordings repeat the motion of the fitted ones: what is proved is proved for that"
    " motion, and names that only another one tells apart may be exchanged."
)
"""Beside causes that no other motion has tried."""

OTHERWISE = 2.0
"""Times that the model is as far off on held-out recordings as on fitted ones, from which they are
taken to move otherwise."""

HURRIED = " Time ended within the fit of sizes (--minutes): they may be far off, intervals too."
"""Beside names whose sizes are what columns at the begin say."""

UNSOUGHT = (
    " No law was looked for in what is left (--law does): where physics is missing, a firm name at"
    " its place may stand for it."
)
"""Beside firm names where nobody looked for what the library lacks."""


def headline(verdict: Verdict) -> str:
    """The verdict and how sure it is."""
    return f"{verdict_sentence(verdict)} {confidence_sentence(verdict)}"


def verdict_sentence(verdict: Verdict) -> str:
    """What was found."""
    names = [_sized(cause) for cause in verdict.causes]
    match verdict.verdict:
        case Kind.NOTHING:
            return _nothing(verdict)
        case Kind.UNKNOWN:
            return _unknown(verdict)
        case _ if verdict.proved:
            return _proved(verdict)
        case Kind.AMBIGUOUS | Kind.PARTIAL:
            named = verdict.naming([name_of(cause) for cause in verdict.causes])
            return named + strained_sentence(verdict)
        case _:
            return verdict.naming(names, _begin(verdict))


def confidence_sentence(verdict: Verdict) -> str:
    """How sure that is."""
    match verdict.verdict:
        case Kind.NOTHING:
            return _shown(verdict)
        case Kind.UNKNOWN if verdict.law is not None and verdict.law.claimed:
            return worth_sentence(verdict.law) + AGAIN * verdict.basis.held_out_repeats
        case Kind.UNKNOWN:
            return _beyond(verdict)
        case _ if verdict.proved:
            rate = percent(verdict.false_discovery_rate)
            hurried = HURRIED if UNFINISHED in verdict.basis.left_out else ""
            firm = any(one.firm for one in verdict.proved)
            if firm and any(what.startswith(LAW) for what in verdict.basis.left_out):
                hurried += UNSOUGHT
            hurried += _otherwise(verdict) + AGAIN * verdict.basis.held_out_repeats
            named = "Only firm names are the mechanism." if firm else "No name is firm."
            return (
                f"{verdict.put_to_proof} {'was' if verdict.put_to_proof == 1 else 'were'} tested on"
                f" held-out data; of those accepted, at most {rate} are expected to be false."
                f" {named}{hurried}"
            )
        case _:
            return _doubt(verdict)


def _otherwise(verdict: Verdict) -> str:
    """That held-out recordings are of another kind of motion, where much more is left of them.

    Of a series elastic joint fitted to slow motion and proved on a chirp neither friction was
    proved: what is wrong with the chirp hid them.
    """
    if verdict.gain is None or verdict.basis.held_out != "measured":
        return ""
    here = {name: one.after_si for name, one in verdict.residuals.items()}
    errors = verdict.gain.errors.items()
    times = {name: after / here[name] for name, (_, after) in errors if here.get(name)}
    most = max(times, key=lambda name: times[name], default="")
    if not most or times[most] < OTHERWISE:
        return ""
    return (
        f" With all that, held-out recordings are {times[most]:.2g} times as far off as the fitted"
        f" ones ({most}): what only these show is not proved there. Of recordings that are long"
        " enough --alternate holds out some of each motion."
    )


def next_step(verdict: Verdict) -> str:
    """What to do next: the first thing that would make it surer, else what to do about it."""
    if verdict.lacks and shorter(verdict):
        return " ".join(filter(None, (check_sentence(verdict), shorter(verdict))))
    if verdict.verdict is not Kind.NOTHING and finer(verdict):
        return finer(verdict)
    if tone(verdict) == "good":
        return "Nothing to do. Smaller faults need a longer recording or more channels."
    if tone(verdict) == "bad":
        names = listed([name_of(cause) for cause in verdict.causes[:TOLD]])
        return f"Look at {names} on the machine, and simulate with the extended model."
    if verdict.proved and verdict.gain is not None and verdict.gain.passed:
        return " ".join(filter(None, (check_sentence(verdict), _with_proved(verdict))))
    if verdict.law is not None and verdict.law.claimed:
        place = verdict.law.place
        return f"Look at {place} on the machine, and simulate with the law in the model."
    return next((text for text in next_sentences(verdict)), "Record another programme.")


def _with_proved(verdict: Verdict) -> str:
    """What to do with causes that are proved to predict better."""
    if verdict.gain is not None and verdict.gain.lost:
        return (
            "Keep the model as it was given: no held-out channel is predicted better than by it."
            " Look at numbers of the model and their tolerances, and diagnose again."
        )
    firm = [spoken(one.label) for one in verdict.proved if one.firm]
    out = ended(verdict)
    wider = (
        f" The range of {listed(out[:TOLD])} ended the fit: if the machine may be farther off than"
        " that, widen it (`largest` of the effect) and diagnose again."
        if out
        else ""
    )
    short = list(dict.fromkeys(b.label for one in verdict.proved for b in one.beyond))
    if short:
        wider += (
            f" As well would do {listed([spoken(name) for name in short[:TOLD]])} beyond the range"
            " that is assumed: if the machine may have as much, widen it (`largest` of the effect)"
            " and diagnose again."
        )
    if firm:
        return f"Simulate with the extended model, and look at {listed(firm[:TOLD])}.{wider}"
    if all(one.ended for one in verdict.proved):
        return "Look for what else is wrong: what was fitted ends its range and stands for that."
    turns = sorted({one.target for one in verdict.proved if one.one_way})
    turn = "reverses" if len(turns) == 1 else "reverse"
    motion = f"in which {listed(turns)} {turn}" if turns else "in which they differ"
    return f"Simulate with the extended model. A motion {motion} settles the names.{wider}"


def tone(verdict: Verdict) -> str:
    """Style of the headline: good, bad, or open where more has to be known."""
    if verdict.verdict is Kind.NOTHING:
        blind = [f for f in verdict.smallest_findable.values() if f.value is None]
        return "open" if blind or verdict.unseen else "good"
    settled = verdict.verdict in (Kind.NAMED, Kind.SEVERAL)
    proven = verdict.gain is not None and verdict.gain.passed
    return "bad" if settled and proven and all(c.firm for c in verdict.causes) else "open"


def _sized(cause: Cause) -> str:
    """A cause with its size, where it is one number."""
    sizes = list(cause.parameters.values())
    return f"{name_of(cause)}, {size_words(sizes[0])}" if len(sizes) == 1 else name_of(cause)


def _nothing(verdict: Verdict) -> str:
    count = len(verdict.smallest_findable)
    if count and _lost(verdict) == count:
        return f"Nothing can be said: this recording would show none of the {count} causes."
    return "Nothing found: what is off lies within noise and the declared tolerances."


def _lost(verdict: Verdict) -> int:
    return sum(f.value is None for f in verdict.smallest_findable.values())


def _shown(verdict: Verdict) -> str:
    """What a recording in which nothing was found would have shown."""
    lost, count = _lost(verdict), len(verdict.smallest_findable)
    if lost:
        return f"This recording can say nothing about {lost} of {count} causes."
    return f"Each of the {count} causes would have shown from the size listed below on."


def _unknown(verdict: Verdict) -> str:
    strange = strangers(verdict)
    if disagree(verdict.alone):
        return (
            "These recordings do not agree. Each alone is in order or has one cause, but nothing"
            " explains all of them."
        )
    if verdict.lawful:
        return verdict.lawful
    if verdict.statistics.misfit_in_order is not None:
        return (
            "Nothing can be told: simulated machines in order fall as far out of step with the"
            " model as this one."
        )
    if strange:
        names = ", ".join(strange[:TOLD])
        return (
            "Something is wrong that no cause in the library explains, and the recording hardly"
            f" looks like one of this machine: most of {names} stays unexplained."
        )
    return "Something is wrong that no cause in the library explains." + strained_sentence(verdict)


def _beyond(verdict: Verdict) -> str:
    """How far what is left is from what machines in order leave."""
    figures = verdict.statistics
    left = figures.misfit if figures.misfit_after is None else figures.misfit_after
    times = left / max(figures.misfit_threshold, 1e-30)
    if times > 1.0:
        most = "noise leaves" if figures.misfit_in_order else "machines in order leave"
        text = f"What is left is {times:.2g} times the most that {most}"
        shares = {n: e.after_si / e.spread for n, e in verdict.residuals.items() if e.spread > 0.0}
        if not shares:
            return f"{text}."
        most = max(shares, key=lambda name: shares[name])
        share = f"{shares[most]:.2g}"
        share = "all" if share == "1" else share
        return f"{text}: {share} of the spread of {most}, less of any other channel."
    return "No cause fits well enough to be accepted."


def _proved(verdict: Verdict) -> str:
    """Of causes that were proved one by one: firm names, those that act like one, what is left."""
    firm = [spoken(one.label) for one in verdict.proved if one.firm]
    loose = (one for one in verdict.proved if not (one.firm or one.ended))
    like = [" with ".join(map(spoken, (o.standing_in or o.label).split(TOGETHER))) for o in loose]
    ended = [spoken(one.label) for one in verdict.proved if one.ended]
    count = len(firm) + len(like)
    what = "1 cause improves" if count == 1 else f"{count or 'No'} causes improve"
    grown = bool(count) and verdict.gain is not None and verdict.gain.grown
    said = f"{what} the prediction of held-out data"
    said += ", but rms errors there grow with all of it." if grown else "."
    begins = ("Firm:", "Something that acts like", "At the end of its range, so not proved:")
    for begin, names in zip(begins, (firm, like, ended), strict=True):
        more = f" and {len(names) - TOLD} more" if len(names) > TOLD else ""
        said += f" {begin} {', '.join(names[:TOLD])}{more}." if names else ""
    said += strained_sentence(verdict)
    if verdict.verdict is Kind.PARTIAL:
        said += " Something more stays unexplained."
    if verdict.law is not None and verdict.law.part and verdict.law.claimed:
        said += f" Of what they leave, a law takes a part: {verdict.law.words}."
    return said


def _begin(verdict: Verdict) -> str:
    proven = verdict.gain is not None and verdict.gain.passed
    return "Found:" if proven and all(c.firm for c in verdict.causes) else "Best explained by"


def _doubt(verdict: Verdict) -> str:
    loose = [cause for cause in verdict.causes if not cause.firm]
    gain = verdict.gain
    if verdict.unconfirmed and gain is not None:
        if not gain.by_causes:
            return "The held-out recordings are explained better without it."
        if gain.grown:
            return "The rms errors on held-out recordings grow with it."
        return "The held-out recordings do not confirm it."
    if loose:
        return _loose(verdict, loose)
    if verdict.basis.held_out == "none":
        it = "Each" if verdict.verdict is Kind.AMBIGUOUS else "It"
        return f"{it} fits these recordings; no other recording has tested it."
    if gain is None or gain.share is None:
        return "The held-out recordings can neither confirm nor refute it."
    share = taken_share(gain)
    return f"Held-out recordings confirm it: there it takes {share} of the error beyond noise away."


OFF = "tolerances off"
"""How a cause ends that may be an error of commissioning."""


def why_loose(cause: Cause) -> str:
    """Why a name is not firm."""
    if cause.below_row:
        return "less than a row of the log, whose clock explains that as well"
    if cause.acts_like:
        like = " or ".join(map(spoken, cause.acts_like))
        return f"in a motion that does not turn round {like} reads the same"
    if any(e.at_limit and not e.value for e in cause.parameters.values()):
        return "none of it would be left, which another cause may do as well"
    if cause.ended:
        return (
            "an end of its range holds it, so that it stands for something else, or the range is"
            " too narrow (`largest` of the effect)"
        )
    if is_sublinear(cause.effect, [size.value for size in cause.parameters.values()]):
        return "friction that grows less than in proportion to speed reads so"
    if not cause.sigmas or all(e.low <= e.nominal <= e.high for e in cause.parameters.values()):
        return "its interval holds what the model has already"
    return f"{cause.sigmas:.1f} {OFF}"


def _loose(verdict: Verdict, loose: list[Cause]) -> str:
    """Of causes that may be commissioning errors, or something else."""
    most = max(cause.sigmas or 0.0 for cause in loose)
    for cause in loose:
        if not why_loose(cause).endswith(OFF):
            return f"{capital(name_of(cause))} is provisional: {why_loose(cause)}."
    which = "It is" if len(verdict.causes) == 1 else f"{name_of(loose[0])} is"
    which = "Each is" if len(loose) == len(verdict.causes) > 1 else capital(which)
    upto = "up to " if len(loose) > 1 else ""
    if verdict.basis.baseline == "measured":
        return (
            f"{which} off by {upto}{most:.1f} times what a machine in order may change by since"
            " its baseline: a fault, or a change that large."
        )
    return (
        f"{which} {upto}{most:.1f} declared tolerances off: a fault, or a machine that was set up"
        " that far off."
    )


def nearest_sentence(verdict: Verdict) -> str:
    """What comes nearest where nothing in the library explains the record; else empty."""
    left = verdict.leftover
    if verdict.verdict is not Kind.UNKNOWN or left is None or disagree(verdict.alone):
        return ""
    if verdict.lawful:
        return ""
    said = ""
    if verdict.suspect:
        said = f"{suspect_words(verdict)} "
        if verdict.gain is not None and verdict.gain.share is not None and verdict.gain.passed:
            said += f"With it {gain_words(verdict)}. More is missing. "
        if verdict.gain is not None and verdict.gain.worse:
            worse = listed(verdict.gain.worse[:TOLD])
            said += (
                f"It predicts {worse} worse than {_than(verdict.gain)}: no candidate is written. "
            )
    if left.loud:
        top = left.loud[0]
        said += f"What is left is loudest in {top.channel} at {ends_words(top)}."
    return said


def _than(gain: Gain) -> str:
    """The model that an extension is held against where it predicts worse."""
    tuned = all(gain.over[name][0] == gain.errors[name][0] for name in gain.worse)
    return "the tolerances alone, tuned" if tuned else "the model as given"


def suspect_words(verdict: Verdict) -> str:
    """The causes that come nearest where none is named, a size with each that has one number."""
    silent = verdict.leftover is None or verdict.lawful or disagree(verdict.alone)
    if verdict.verdict is not Kind.UNKNOWN or not verdict.suspect or silent:
        return ""
    names = " with ".join(map(spoken, verdict.suspect.split(" with ")))
    sized = " with ".join(map(_sized, verdict.nearest))
    return f"Nearest, and not accepted: {sized or names}."


def strangers(verdict: Verdict) -> list[str]:
    """Channels of which the best explanation leaves more than half of their own movement."""
    return [
        name
        for name, error in verdict.residuals.items()
        if error.after > 10.0 and error.after_si > STRANGER * error.spread
    ]
