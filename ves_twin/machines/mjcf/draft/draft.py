"""draft: a model and its logs to the text of a machine's file, with what was guessed and why."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from ves_twin.core.errors import InvalidInputError
from ves_twin.data.clock.usual_period import is_usual
from ves_twin.machines.mjcf.draft.angles import counted
from ves_twin.machines.mjcf.draft.by_number import by_number
from ves_twin.machines.mjcf.draft.check import Checked
from ves_twin.machines.mjcf.draft.chosen import Chosen
from ves_twin.machines.mjcf.draft.constants import with_constants
from ves_twin.machines.mjcf.draft.draft_text import (
    compared,
    integrated,
    signal_name,
    slower_of,
    used,
)
from ves_twin.machines.mjcf.draft.drafting import Drafting
from ves_twin.machines.mjcf.draft.estimates import LOW_PASSED
from ves_twin.machines.mjcf.draft.given_model import GivenModel
from ves_twin.machines.mjcf.draft.held_stretch import held_stretch, too_short
from ves_twin.machines.mjcf.draft.in_counts import in_counts, without_counts
from ves_twin.machines.mjcf.draft.log_columns import LogColumns
from ves_twin.machines.mjcf.draft.match import Match, Matches, matched
from ves_twin.machines.mjcf.draft.names import is_command
from ves_twin.machines.mjcf.draft.shape import by_shape
from ves_twin.machines.mjcf.draft.spots import Quantity, Spot, spots_of
from ves_twin.machines.mjcf.draft.steady import with_steady
from ves_twin.machines.mjcf.draft.untold import untold
from ves_twin.machines.mjcf.recordings.columns import read_rig_recording
from ves_twin.machines.mjcf.rig.description import Mode


@dataclass(frozen=True)
class Guess:
    """One column: what it is taken for, why, and what else it could be."""

    column: str
    taken_for: str
    why: str
    others: str


@dataclass(frozen=True)
class Draft:
    """A machine's file that nobody wrote yet.

    Attributes:
        text: of the file.
        model_text: MJCF to write beside it, where the model is a URDF; else empty.
        guesses: one for each column that was matched.
        left: column -> why it is not used.
        look: what a person should look at, a sentence each.
        mode: what is fed in, and why.
        explained: column or signal -> share of its power that the model as it is explains.
        stretch: length of stretches to hold out [s], long enough for a diagnosis; 0 where the log
            is too short for two, or in pieces already.
        rubs: columns or signals that friction explains, and the model does not.
        gravity: that the model should have, as its file has it; empty where it is right.
        short: whether a diagnosis would find the log, or a piece of it, too short.
        untold: column -> unit of a constant that nothing tells, where 1 is taken.
        one_only: whether no length of stretches was found that has rows enough in each.
        odd_clock: whether rows are as far apart as in no laboratory: lengths are not known then.
    """

    text: str
    model_text: str
    guesses: tuple[Guess, ...]
    left: dict[str, str]
    look: tuple[str, ...]
    mode: str
    explained: dict[str, float]
    stretch: float
    rubs: tuple[str, ...] = ()
    gravity: str = ""
    short: bool = False
    one_only: bool = False
    odd_clock: bool = False
    untold: Mapping[str, str] = field(default_factory=dict)


def draft(
    model: Path,
    logs: Sequence[Path],
    out: Path,
    rate: float | None = None,
    scales: Mapping[str, float] | None = None,
) -> Draft:
    """Draft the file that makes a model and logs of it a machine.

    Args:
        model: MJCF or URDF.
        logs: the first is matched; the others must have the columns that it needs.
        out: where the file will lie: paths in it start from there.
        rate: rows a second, where no column tells the time.
        scales: constants that are known, as of a motor: column -> what one of its unit is.

    Raises:
        FileAccessError: a file that is missing.
        InvalidInputError: files that cannot be read, or do not fit each other.
    """
    if not logs:
        raise InvalidInputError("logs", "none", "at least one")
    given, log = GivenModel.read(model), LogColumns.read(logs[0], rate)
    spots = spots_of(given.model)
    log, matches, counts = _matched(log, spots, scales or {})
    log, matches = with_steady(log, matches, spots)
    matches = with_constants(matches, scales or {})
    measured = [m for m in matches.found if m.spot.quantity is not Quantity.EFFORT]
    measured += [
        m for m in matches.of(Quantity.EFFORT) if not is_command(log.said.get(m.column, m.column))
    ]
    log = log.between([m.column for m in measured]).beside(logs[1:], rate)
    drafting = Drafting(model, logs[0], out, given, log, matches)
    now = drafting.best()
    others = [read_rig_recording(further, now.rig) for further in logs[1:]]
    left = dict(matches.left)
    left |= {m.column: f"{m.spot.label} in counts: what one is, nothing tells" for m in counts}
    left |= {c: "says what was asked for" for c in matches.setpoints}
    left |= {m.column: "is a speed" for m in now.check.found if not used(m, now.mode)}
    silent = untold(given.model, now.check.found, now.check.locked)
    turned, rubs = drafting.other_way(now)
    coarse = [] if turned else now.coarse
    short, smooth = too_short(now.rig, now.part), _smooth(now.mode)
    short += [words for one in others for words in too_short(now.rig, one)]
    words = f"{now.mode.mode}: {now.mode.why}"
    odd = not is_usual(log.period)
    stretch = 0.0 if short or odd else held_stretch(now, log)
    found = (
        *given.notes,
        *log.notes,
        *_slower(log, slower_of(now.check.found, now.mode, log)),
        *now.check.findings,
    )
    look = (*found, *silent, *turned, *coarse, *smooth, *short)
    unknown = {m.column: m.per for m in now.check.found if m.fitted and abs(m.scale) == 1.0}
    per_count = {
        m.alone or m.column: f"{m.spot.unit} per count"
        for m in (*counts, *counted(log, now.check.found))
    }
    told = {name: max(share, 0.0) for name, share in now.explained.items()}
    return Draft(
        text=now.text,
        model_text=given.text,
        guesses=_guesses(now.check, now.mode),
        left=left,
        look=look,
        mode=words,
        explained=told,
        stretch=stretch,
        rubs=tuple(now.explained) if rubs else now.check.rubs,
        gravity=now.check.gravity,
        short=bool(short),
        one_only=not (stretch or short or odd or now.mode.horizon),
        odd_clock=odd,
        untold={**per_count, **unknown},
    )


def _matched(
    log: LogColumns, spots: tuple[Spot, ...], scales: Collection[str]
) -> tuple[LogColumns, Matches, list[Match]]:
    """Columns with their spots, and those in counts that would have one if a count were known."""
    found = by_number(log, by_shape(log, matched(log, spots), spots), spots)
    counts = in_counts(log, spots, found)
    known = [match.column for match in counts if match.column in scales]
    return _matched(without_counts(log, known), spots, ()) if known else (log, found, counts)


def _slower(log: LogColumns, names: Sequence[str]) -> list[str]:
    """That readings come more slowly than rows, if they do."""
    if not names:
        return []
    rate = min(1.0 / log.readings(name)[1] for name in names)
    most = max(log.slower[name].repeats for name in names)
    return [
        f"{', '.join(names)}: a reading is repeated for up to {most} rows until the next one"
        f" comes, {rate:.2g} Hz in all: rows between are taken straight (`repeats`)"
    ]


def _smooth(mode: Chosen) -> list[str]:
    """That efforts were low-passed, if they were, where motion is given and noise weighs them."""
    found = [column for column, (_, how) in mode.noise.items() if how.startswith(LOW_PASSED)]
    if not found or mode.mode is not Mode.MOTION:
        return []
    return [
        f"{', '.join(found)}: low-passed, which took the noise away: half a per cent of the size is"
        " assumed, write what you know; were the positions filtered alike?"
    ]


def _guesses(check: Checked, mode: Chosen) -> tuple[Guess, ...]:
    found = []
    for match in check.found:
        way = "compared" if compared(match, mode) else "fed in"
        if not used(match, mode):
            continue
        unit = match.unit if match.told else f"{match.unit}?"
        if match.fitted:
            unit = f"{match.unit}, {match.constant}"
        sign = "-" if match.scale < 0.0 else ""
        way = f"integrated, {way}" if integrated(match, mode) else way
        taken = f"{sign}{match.spot.label} [{unit}], {way} as {signal_name(match, mode)}"
        found.append(Guess(match.column, taken, ", ".join(match.reasons), "; ".join(match.others)))
    return tuple(found)
