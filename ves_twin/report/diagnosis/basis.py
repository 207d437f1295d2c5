"""rests_on, basis_sentences, gain_words: what a verdict rests on, and what it is worth."""

from __future__ import annotations

from ves_twin.core.quantity import shares
from ves_twin.diagnosis.fit.tolerances import FEWEST
from ves_twin.diagnosis.unseen.gain import Gain
from ves_twin.diagnosis.verdict.verdict import Basis, Kind, Verdict
from ves_twin.report.diagnosis.coarse_step import coarse_sentence
from ves_twin.report.diagnosis.out_of_step import out_of_step_sentence

NEARLY_ALL = 0.99
"""Share from which more digits tell nobody anything."""

STAYS = 0.005
"""Change of an rms error that no per cent tells."""

FEW = 4
"""Parts of the work without time that are told by name; verdict.json has all."""

LOUD = 3.0
"""Sigma of what is left of a channel from which that is more than noise."""

GIVEN = {
    ("noise", "measured"): "noise measured at a standstill",
    ("noise", "declared"): "the declared noise",
    ("tolerances", "measured"): "tolerances measured on machines in order",
    ("tolerances", "declared"): "the declared tolerances",
    ("held_out", "measured"): "held-out recordings",
    ("held_out", "split"): "every second stretch of the record, held out",
    ("baseline", "measured"): "a recording of this machine in order",
}
"""Field of a basis and what it says -> what was there."""

AGAIN = " that repeat the fitted motion"
"""Beside held-out recordings that do."""

MISSING = {
    ("held_out", "none"): "a held-out recording",
    ("baseline", "none"): "a recording of this machine in order",
}
"""The same -> what was not there."""


def rests_on(basis: Basis) -> str:
    """What a verdict rests on and what nobody gave, in one sentence."""
    fields = ("noise", "tolerances", "held_out", "baseline")
    keys = [(name, getattr(basis, name)) for name in fields]
    again = AGAIN * basis.held_out_repeats
    given = [GIVEN[k] + again * (k == ("held_out", "measured")) for k in keys if k in GIVEN]
    there = _listed(given)
    absent = " or ".join(MISSING[key] for key in keys if key in MISSING)
    said = f"{there}; {absent} was not given." if absent else f"{there}."
    return " ".join([said, *_pieces(basis), *_left_out(basis)])


def _listed(names: list[str]) -> str:
    return f"{', '.join(names[:-1])} and {names[-1]}" if len(names) > 1 else names[0]


def taken_share(gain: Gain) -> str:
    """How much of what is there an extension takes away: no more than all of it."""
    return _taken(gain)[0]


def taken_words(gain: Gain) -> str:
    """The same, of what, and within which range."""
    share, low, high = _taken(gain)
    span = f" ({low} to {high})" if low else ""
    if _open(gain):
        span = ", or none, or a loss: that is not known"
    return f"{share} of the error beyond noise on held-out recordings{span}"


def gain_words(verdict: Verdict) -> str:
    """How much an extension takes away on held-out recordings; empty where none shows it.

    Two measures where more than noise stays, since they differ (the damper: 6 and 79 %): the second
    counts every frequency in units of its own noise.
    """
    gain = verdict.gain
    if gain is None or gain.share is None:
        return ""
    if verdict.basis.by_motion and gain.errors:  # the noise of such efforts is not known
        return rms_words(gain)
    both = verdict.verdict in (Kind.PARTIAL, Kind.UNKNOWN) or gain.grown
    if not both or not gain.errors:
        return taken_words(gain) + _lost_words(verdict)
    share, low, high = _taken(gain)
    span = f" ({low} to {high})" if low else ""
    square = f"of its square in units of noise, {share}{span} goes"
    if gain.fallen and gain.high is not None and gain.high < 0.0:
        square = f"{square}: slow errors fall, and fast ones, which noise weighs most, grow"
    elif gain.share <= 0.0:
        square = "its square in units of noise, where fast errors count most, does not fall"
    if _open(gain):
        square = "counted in units of noise it may be a loss as well"
    lost = "; the model as it was given predicts every channel as well or better" * gain.lost
    square = "" if gain.over is not gain.errors else f"; {square}"  # that is over its bad tuning
    return f"{rms_words(gain)}{square}{lost}{_lost_words(verdict)}"


def _open(gain: Gain) -> bool:
    """Whether the interval of a share says next to nothing: a loss of all there was, or worse."""
    return gain.low is not None and gain.low < -1.0


def _lost_words(verdict: Verdict) -> str:
    """Which channels are predicted no better than by their mean, after whatever gain.

    A crane's trolley that ran away by 28.7 m did so by 0.33 m then, of 0.17 m that it moves by: a
    gain of 99 %.
    """
    errors = verdict.gain.errors if verdict.gain else {}
    own = {name: one for name, one in verdict.residuals.items() if one.after > LOUD}
    lost = [name for name, (_, left) in errors.items() if name in own and left > own[name].spread]
    verb = "is" if len(lost) == 1 else "are"
    return f"; {_listed(lost)} {verb} still predicted worse than by a constant" if lost else ""


def rms_words(gain: Gain) -> str:
    """What happens to the rms error on held-out recordings, where it falls most and least."""
    falls = {name: 1.0 - after / before for name, (before, after) in gain.told.items() if before}
    ends = sorted(falls, key=lambda name: falls[name])
    told_of = dict.fromkeys((*ends[-1:], *ends[:1]))
    told = [_moved(falls[name], name) for name in told_of]
    words = " and ".join(told) or "stays"
    if len(told) > 1 and all(one.startswith("falls ") for one in told):
        words = f"{told[0]} and {told[1].removeprefix('falls ')}"
    bent = any(gain.told[name][0] < gain.errors[name][0] for name in told_of)
    tuned = any(gain.told[name][0] < (1.0 - STAYS) * gain.given.get(name, 0.0) for name in told_of)
    over = ", over what the model leaves with its tolerances fitted" * tuned
    over = ", over the model as given where its tuning is worse" if bent else over
    return f"the rms error on held-out recordings {words}{over}"


def _moved(fall: float, name: str) -> str:
    if abs(fall) < STAYS:
        return f"stays ({name})"
    return f"{'falls' if fall > 0.0 else 'grows'} by {shares(abs(fall))[0]} ({name})"


def _taken(gain: Gain) -> tuple[str, str, str]:
    if gain.low is not None and gain.low > NEARLY_ALL:
        return f"more than {100.0 * NEARLY_ALL:.0f} %", "", ""
    ends = (None if end is None else min(end, 1.0) for end in (gain.share, gain.low, gain.high))
    share, low, high = shares(*ends)
    return (share, "", "") if low == high else (share, low, high)


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
    said = gain_words(verdict)
    if gain.passed:
        return f"Gain: {said}."
    if not gain.by_causes:
        return f"Gain: {said}. But the same rig without the cause predicts them better."
    if gain.grown:
        return f"Gain: {said}. That is none, since the rms errors grow."
    if verdict.proved and gain.fallen:
        return f"Gain: {said}. The error of every channel falls."
    return f"Gain: {said}. That is no clear gain."


def basis_sentences(verdict: Verdict) -> tuple[str, ...]:
    """On what the verdict rests, in plain words."""
    basis, limit = verdict.basis, verdict.statistics.naming_limit
    noise = {
        "measured": "Noise: measured at a standstill.",
        "declared": "Noise: as declared; no standstill recording was given.",
    }
    unit = "tolerances"
    if basis.baseline == "measured":
        unit = "times what a machine in order may change since its baseline"
    beyond = f" A deviation counts as a fault from {limit:.1f} {unit} on." if limit else ""
    scale = verdict.statistics.tolerance_scale or 0.0
    tolerances = {
        "measured": "Tolerances: measured on commissioning recordings,"
        f" {scale:.2g} times the declared ones.{beyond}",
        "declared": "Tolerances: declared, not measured; they may be too small. With"
        f" {FEWEST} commissioning recordings they would be measured.{beyond}",
    }
    held = {
        "measured": "Held-out recordings: given."
        + " They repeat the fitted motion." * basis.held_out_repeats,
        "split": "Held-out recordings: none were given. The record was cut into stretches, and"
        " every second one was held out.",
        "none": "Held-out recordings: none. The verdict was not tested on other data.",
    }
    return (
        noise.get(basis.noise, f"Noise: {basis.noise}."),
        tolerances.get(basis.tolerances, f"Tolerances: {basis.tolerances}."),
        held.get(basis.held_out, f"Held-out recordings: {basis.held_out}."),
        *_repeats(basis),
        *_pieces(basis),
        *_left_out(basis),
        *filter(None, [coarse_sentence(verdict), out_of_step_sentence(verdict)]),
    )


def _pieces(basis: Basis) -> tuple[str, ...]:
    """That recordings were cut, which every error and gain is told of."""
    if not basis.pieces:
        return ()
    return (f"What was fitted was simulated in {basis.pieces} pieces, each from its own start.",)


def _left_out(basis: Basis) -> tuple[str, ...]:
    """What was left out to save time, as it would have taken too much of it."""
    if not basis.left_out:
        return ()
    few, count = list(basis.left_out[:FEW]), len(basis.left_out) - FEW
    named = _listed([*few, *([f"{count} more"] if count > 0 else [])])
    return (f"Left out to save time: {named}; --minutes gives more.",)


def _repeats(basis: Basis) -> tuple[str, ...]:
    """How well the baseline's inputs are those of the record."""
    if not basis.baseline_differs:
        return ()
    share = f"{100.0 * basis.baseline_differs:.2g} %"
    return (f"Baseline: its inputs differ from the record's by up to {share} of their range.",)
