"""Sentences that say what a comparison found: trust, size of the gap, limits, where it lives."""

from __future__ import annotations

from math import sqrt

from ves_twin.core.quantity import digits, percent, quantity
from ves_twin.data.quality.check import Grade
from ves_twin.diagnosis.record.residuals.cells import Cell
from ves_twin.diagnosis.record.residuals.channel import FAR, LOUD, ChannelComparison
from ves_twin.machines.comparison import Basis, Comparison, RecordingComparison
from ves_twin.machines.tolerance import Excess

NAMED = 3
"""Channels named in a sentence."""

EXPECTED_OUTSIDE = 0.15
"""Share of the rows outside the envelope from which a column counts as outside: noise alone, which
takes 5 % of them outside, does not reach it."""

CONTRAST = 1.5
"""One regime is named where the residual is larger there by this factor."""

HELD_AGAINST = {
    Basis.PLANT: "the plant's answer to its set-points",
    Basis.RECORDING: "the other recording of the same programme",
    Basis.RESIDUAL: "the other recording, each less the plant's answer to its own set-points",
}


FED_IN = {
    "motion": "joints moved as recorded (inverse dynamics)",
    "control": "efforts fed in as recorded (open loop)",
    "free": "nothing: the model is let go",
    "reference": "set-points fed into the controllers (closed loop)",
}
"""How the simulation was fed, by mode."""


def fed_words(recording: RecordingComparison) -> str:
    """How the simulation was fed."""
    if recording.imposed:
        return f"{', '.join(recording.imposed)} moved as recorded, all else integrated"
    return FED_IN[recording.mode]


def trust_sentence(recording: RecordingComparison) -> str:
    """Whether the data can be trusted."""
    failed = [c for c in recording.checks if c.grade is Grade.FAILED]
    doubts = [c for c in recording.checks if c.grade is Grade.UNKNOWN]
    asked = len(recording.checks)
    if not asked:
        return "Data: poses at rest; the checks are for records in time."
    if failed:
        return (
            f"Data: {len(failed)} of {asked} quality checks failed. What follows may come from the"
            " recording and not from the rig."
        )
    if doubts:
        names = ", ".join(dict.fromkeys(c.name for c in doubts))
        return (
            f"Data: {asked - len(doubts)} of {asked} checks passed; {len(doubts)} could not be"
            f" evaluated: {names}."
        )
    return f"Data: all {asked} quality checks passed."


def gap_sentence(recording: RecordingComparison) -> str:
    """How large the gap is, in words, SI and sigma."""
    loud, count = recording.beyond_noise, len(recording.channels)
    if not loud:
        top = max(recording.channels, key=lambda c: c.loudness, default=None)
        most = f" (largest: {top.name} {size(top)})" if top else ""
        return f"Gap: none beyond noise in any of {count} columns{most}."
    names = ", ".join(f"{c.name} {size(c)}" for c in loud[:NAMED])
    return f"Gap: {len(loud)} of {count} columns are beyond noise. Loudest: {names}."


def envelope_sentence(recording: RecordingComparison) -> str:
    """Whether a machine in order may look like this; empty where nobody computed it."""
    outside = recording.outside
    if not outside:
        return ""
    far = sorted((n for n, s in outside.items() if s > EXPECTED_OUTSIDE), key=lambda n: -outside[n])
    count = len(outside)
    if not far:
        wide, more = recording.wide, ""
        if wide:
            some = f"{', '.join(wide[:NAMED])}{' and more' if len(wide) > NAMED else ''}"
            more = f" That of {some} is wider than it moves, and tells next to nothing."
        return f"Tolerances: all {count} columns lie in the band of a machine in order.{more}"
    named = ", ".join(f"{n} in {percent(outside[n])} of its rows" for n in far[:NAMED])
    return (
        f"Tolerances: {len(far)} of {count} columns leave the band of a machine in order: {named}."
        " One column in twenty does so by chance; ves-twin diagnose tells whether it is a fault."
    )


def rests_on(recording: RecordingComparison) -> str:
    """Who says how large noise and tolerances are."""
    noise = recording.notes[0]
    return f"{noise}; tolerances as declared." if recording.outside else f"{noise}."


def size(channel: ChannelComparison) -> str:
    """Rms of a column in SI and in sigma."""
    return f"{quantity(channel.rms, channel.unit)} rms = {digits(channel.rms_sigma)} sigma"


def tolerance_sentence(comparison: Comparison) -> str:
    """Whether the limits are kept."""
    if comparison.excesses is None:
        return "Limits: none given (--tolerance)."
    if not comparison.excesses:
        return "Limits: every one is kept."
    count = len(comparison.excesses)
    some = ", ".join(excess_words(e) for e in comparison.excesses[:NAMED])
    rest = f" and {count - NAMED} more" if count > NAMED else ""
    return f"Out of tolerance: {some}{rest}."


def excess_words(excess: Excess) -> str:
    """One limit that is not kept."""
    limit = quantity(excess.limit, excess.unit)
    if excess.found is None:
        return f"{excess.channel} {excess.measure} (not compared, limit {limit})"
    found = quantity(excess.found, excess.unit)
    return f"{excess.channel} {excess.measure} {found} (limit {limit})"


def cost_sentence(recording: RecordingComparison) -> str:
    """What the gap costs the emulation; empty where nothing is emulated."""
    cost = recording.cost
    if cost is None:
        return ""
    pose = ""
    if cost.translation is not None:
        pose = (
            f" The platform itself is off by {quantity(cost.translation, 'm')} and"
            f" {quantity(cost.rotation, 'rad')} rms."
        )
    peaks = f"{digits(cost.force_share, '.2g')} and {digits(cost.moment_share, '.2g')}"
    base = f"{quantity(cost.base_translation, 'm')} and {quantity(cost.base_rotation, 'rad')}"
    return (
        f"Cost for the emulation of {cost.emulated}: the wrench gap is {quantity(cost.force, 'N')}"
        f" and {quantity(cost.moment, 'N*m')} rms, noise included; its peaks are {peaks} times the"
        f" 1 N and 1.5 N m that thesis 3.2.3 allows. Alone it would move the emulated base by up to"
        f" {base}.{pose}"
    )


def place_sentence(channel: ChannelComparison) -> str:
    """Where a column's gap lives: band, stretch, regime, lag, colour."""
    parts = []
    for cells, word in ((channel.bands, "at"), (channel.blocks, "in")):
        top = max(cells, key=lambda c: c.score, default=None)
        if top is not None and top.score > LOUD:
            parts.append(f"{word} {top.label} ({digits(top.sigma, '.2g')} sigma)")
    where = f"loudest {' and '.join(parts)}" if parts else "a constant; nothing of it moves"
    text = f"{channel.name} ({channel.axis}): {where}"
    for kind in ("velocity", "position", "load") if parts else ():
        text += _contrast([c for c in channel.regimes if c.kind == kind], channel.mean)
    if abs(channel.mean_score) > FAR:
        text += f"; mean {quantity(channel.mean, channel.unit)}"
    lag = channel.lag
    if lag is not None and abs(lag.value) > 4.0 * lag.sd and abs(lag.value) > 5e-5:
        later = "later" if lag.value > 0 else "earlier"
        text += f"; {abs(lag.value) * 1e3:.2g} +- {lag.sd * 1e3:.1g} ms {later} than expected"
    coherence = channel.coherence
    if coherence is not None and coherence.told and coherence.value > 0.3:
        text += f"; {coherence.value:.0%} of it goes along with {coherence.column}"
    return f"{text}."


def _contrast(cells: list[Cell], mean: float) -> str:
    """Where one regime is clearly larger than the least one, or its mean clearly apart.

    As large as it is, with the mean of the whole, which the cells have taken off: dry friction of
    a joint that mostly turns one way is not largest where it stands. Else about that mean.
    """
    if len(cells) < 2:
        return ""
    whole = [sqrt(max(c.rms**2 + 2.0 * mean * c.mean + mean**2, 0.0)) for c in cells]
    beside = [c.rms for c in cells]  # an offset may hide it
    for rms, about in ((whole, ""), (beside, "beside its mean ")):
        most, fewest = max(rms), min(rms)
        top, least = cells[rms.index(most)], cells[rms.index(fewest)]
        if not fewest > 0.0 or most <= CONTRAST * fewest:
            continue
        (name, _, state), other = top.label.rpartition(" "), least.label.rpartition(" ")[2]
        times = f"{most / fewest:.2g} times"
        return f"; {about}{times} as large while {name} is {state} as while it is {other}"
    apart = max(cells, key=lambda c: abs(c.mean))
    if abs(apart.mean) > 0.6 * top.rms:
        name, _, state = apart.label.rpartition(" ")
        return f"; its mean is another while {name} is {state}"
    return ""
