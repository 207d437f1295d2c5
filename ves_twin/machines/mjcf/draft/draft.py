"""draft: a model and its logs to the text of a machine's file, with what was guessed and why."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.recording import Recording
from ves_twin.diagnosis.record.preprocess import check_lengths
from ves_twin.machines.mjcf.draft.by_number import by_number
from ves_twin.machines.mjcf.draft.check import Checked, checked
from ves_twin.machines.mjcf.draft.chosen import Chosen, chosen
from ves_twin.machines.mjcf.draft.commanded import as_commanded
from ves_twin.machines.mjcf.draft.draft_text import compared, draft_text, signal_name, used
from ves_twin.machines.mjcf.draft.estimates import LOW_PASSED
from ves_twin.machines.mjcf.draft.given_model import GivenModel
from ves_twin.machines.mjcf.draft.log_columns import LogColumns
from ves_twin.machines.mjcf.draft.match import matched
from ves_twin.machines.mjcf.draft.other_way import other_way
from ves_twin.machines.mjcf.draft.predicted import AWAY, FEWEST, predicted
from ves_twin.machines.mjcf.draft.runs_away import runs_away
from ves_twin.machines.mjcf.draft.shape import by_shape
from ves_twin.machines.mjcf.draft.spots import spots_of
from ves_twin.machines.mjcf.draft.unmeasured import unmeasured
from ves_twin.machines.mjcf.draft.untold import untold
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.motion.pieces import pieces
from ves_twin.machines.mjcf.recordings.columns import read_rig_recording
from ves_twin.machines.mjcf.recordings.interleaved_split import alternate, enough
from ves_twin.machines.mjcf.rig.description import KIND, Mode, RigDescription
from ves_twin.machines.mjcf.rig.machine import Rig

HALF = 0.5
"""Share of a signal that a model must explain open loop for commands to be fed in: an arm that
drifts off its path tells nothing."""

ROWS = 150
"""Rows of the analysis in a stretch: half as many again as a diagnosis asks for."""

STRETCH = 2.0
"""Usual length of a stretch that is held out [s]."""

LONGEST = 60.0
"""Stretch of a log that is predicted to say how near the model is [s]."""

HORIZONS = (10.0, 5.0, 3.0, 2.0, 1.5, 1.0, 0.5)
"""Pieces that are tried where the model runs away from a log [s], the longest first."""

HELPS = 0.1
"""Share of a signal's power that a horizon must explain more for it to be taken."""


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
        rubs: columns of efforts that friction explains, and the model does not.
        gravity: that the model should have, as its file has it; empty where it is right.
        short: whether a diagnosis would find the log, or a piece of it, too short.
        one_only: whether no length of stretches was found that has rows enough in each.
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


def draft(model: Path, logs: Sequence[Path], out: Path, rate: float | None = None) -> Draft:
    """Draft the file that makes a model and logs of it a machine.

    Args:
        model: MJCF or URDF.
        logs: the first is matched; the others must have the columns that it needs.
        out: where the file will lie: paths in it start from there.
        rate: rows a second, where no column tells the time.

    Raises:
        FileAccessError: a file that is missing.
        InvalidInputError: files that cannot be read, or do not fit each other.
    """
    if not logs:
        raise InvalidInputError("logs", "none", "at least one")
    given, log = GivenModel.read(model), LogColumns.read(logs[0], rate)
    spots = spots_of(given.model)
    matches = by_number(log, by_shape(log, matched(log, spots), spots), spots)
    check = checked(log, matches, given.model)
    file = out.with_suffix(".xml").name if given.text else os.path.relpath(model, out.parent)

    def version(mode: Chosen, other: Checked | None = None) -> _Version:
        told = other or check
        text = draft_text(out.stem, model, file, log, matches, told, mode, given.model)
        rig = _rig(text, given, out)
        if mode.mode is Mode.MOTION:
            return _Version(mode, text, rig, dict(told.explained), [])
        return _Version(mode, text, rig, *predicted(rig, _first_part(rig, logs[0])))

    now = version(chosen(log, matches, check, given.model))
    part = _first_part(now.rig, logs[0])
    simulated = now.mode.mode is not Mode.MOTION and len(part.time) >= FEWEST
    if simulated:
        sizes = unmeasured(now.rig, part)
        now = version(replace(now.mode, typical=sizes)) if sizes else now
        check, now = _by_simulation(now, check, version)
    if now.mode.either and now.explained[now.least] < HALF:
        why = f"open loop the model explains {_percent(now)} of {now.least}"
        now = version(chosen(log, matches, check, given.model, why))
    if now.mode.mode is Mode.CONTROL and simulated and now.explained[now.least] < HALF:
        drifts = now.explained[now.least] < AWAY
        if drifts or runs_away(MjcfForward.of(now.rig), read_rig_recording(logs[0], now.rig)):
            now = _in_pieces(now, version, 1.0 / log.period)
    for further in logs[1:]:
        read_rig_recording(further, now.rig)
    left = dict(matches.left)
    left |= {c: "says what was asked for" for c in matches.setpoints}
    left |= {m.column: "is a speed" for m in check.found if not used(m, now.mode)}
    silent = untold(given.model, check.found, check.locked)
    turned: list[str] = []
    if now.mode.mode is Mode.CONTROL and simulated and now.explained[now.least] < HALF:
        turned = other_way(now.rig, _first_part(now.rig, logs[0]))
        cut = None if turned else _shortest(now, version, 1.0 / log.period)
        turned = other_way(cut, _first_part(cut, logs[0])) if cut else turned
    coarse = [] if turned else now.coarse
    short = _short(now.rig, part)
    smooth = _smooth(now.mode)
    words = f"{now.mode.mode}: {now.mode.why}"
    stretch = 0.0 if short else _stretch(now, part, log)
    look = (*given.notes, *log.notes, *check.findings, *silent, *turned, *coarse, *smooth, *short)
    guesses = _guesses(check, now.mode)
    told = {name: max(share, 0.0) for name, share in now.explained.items()}
    one_only = not (stretch or short or now.mode.horizon)
    beside = (stretch, check.rubs, check.gravity, bool(short), one_only)
    return Draft(now.text, given.text, guesses, left, look, words, told, *beside)


@dataclass(frozen=True)
class _Version:
    """A draft in one mode, with what it explains and what its step spoils."""

    mode: Chosen
    text: str
    rig: Rig
    explained: dict[str, float]
    coarse: list[str]

    @property
    def least(self) -> str:
        """What it explains least of."""
        return min(self.explained, key=lambda name: self.explained[name])


def _by_simulation(
    now: _Version, check: Checked, version: Callable[[Chosen, Checked], _Version]
) -> tuple[Checked, _Version]:
    """With the model's own commands in place of fitted constants, where that explains more."""
    plain = as_commanded(check) if now.mode.mode is Mode.CONTROL else None
    if plain is None:
        return check, now
    other = version(now.mode, plain)
    return (
        (plain, other) if other.explained[other.least] > now.explained[now.least] else (check, now)
    )


def _in_pieces(whole: _Version, version: Callable[[Chosen], _Version], native: float) -> _Version:
    """With the longest horizon over which the model explains HALF, or that which explains most.

    Where no horizon helps, or no row tells a joint's start, all stays as it is. A piece has ROWS of
    the analysis, which has no more of them than the log, `native` a second.
    """
    mode, share = whole.mode, whole.explained[whole.least]
    why = f"{mode.why}; over the whole log the model explains {_percent(whole)} of {whole.least}"
    best, found = share + HELPS, whole
    for horizon in _horizons(mode, native):
        try:
            cut = version(replace(mode, horizon=horizon, why=why))
        except InvalidInputError:  # a joint whose start no row tells
            break
        if cut.explained[cut.least] > best:
            best, found = cut.explained[cut.least], cut
        if found.explained[found.least] >= HALF:
            break
    return found


def _horizons(mode: Chosen, native: float) -> list[float]:
    """Pieces [s] that have enough rows, the longest first."""
    return [h for h in HORIZONS if h * min(mode.rate, native) >= ROWS]


def _shortest(whole: _Version, version: Callable[[Chosen], _Version], native: float) -> Rig | None:
    """The machine in the shortest pieces, where a swing that runs away is told from its turned one.

    None where it is in pieces already, or no row tells a joint's start.
    """
    usable = _horizons(whole.mode, native)
    if whole.mode.horizon or not usable:
        return None
    try:
        return version(replace(whole.mode, horizon=usable[-1])).rig
    except InvalidInputError:
        return None


def _percent(version: _Version) -> str:
    """What it explains least of; a simulation that runs away explains nothing."""
    return f"{max(version.explained[version.least], 0.0):.0%}"


def _stretch(now: _Version, part: Recording, log: LogColumns) -> float:
    """Length of stretches to hold out [s]; a last one of half a length is one, too.

    The shortest that is enough where the usual one is not; 0 where none is, or the log is in pieces
    already.
    """
    length = max(STRETCH, float(np.ceil(ROWS / now.mode.rate)))
    if now.mode.horizon:
        return 0.0
    whole = log.period * (log.rows - 1)
    if float(np.ptp(part.time)) <= 1.5 * length < whole:  # a part alone was simulated
        return length
    if len(part.time) < FEWEST:
        return 0.0
    usable = (one for one in (length, enough(part, now.mode.rate)) if _splits(now.rig, part, one))
    return next(usable, 0.0)


def _splits(rig: Rig, part: Recording, length: float) -> bool:
    """Whether stretches of a length [s] are two or more, each long enough for a diagnosis."""
    try:
        fit, held = alternate(part, length, rig.description.rate)
    except InvalidInputError:
        return False
    return not any(_short(rig, one) for one in (*fit, *held))


def _smooth(mode: Chosen) -> list[str]:
    """That efforts were low-passed, if they were, where motion is given and noise weighs them."""
    found = [column for column, (_, how) in mode.noise.items() if how.startswith(LOW_PASSED)]
    if not found or mode.mode is not Mode.MOTION:
        return []
    return [
        f"{', '.join(found)}: low-passed, which took the noise away: half a per cent of the size is"
        " assumed, write what you know; were the positions filtered alike?"
    ]


def _short(rig: Rig, part: Recording) -> list[str]:
    """That a log, or a piece of it, is too short for a diagnosis, if it is."""
    if len(part.time) < FEWEST:  # a clock in another unit, which is told
        return []
    parts = pieces(rig, part)
    try:
        check_lengths(MjcfForward.of(rig), parts, rig.description.rate)
    except InvalidInputError as short:
        return [f"too short for a diagnosis: {short}"]
    return []


def _rig(text: str, given: GivenModel, out: Path) -> Rig:
    """The machine of a text, before anything is written; its model is compiled already."""
    content = tomllib.loads(text)
    if content.pop("schema", None) is None or content.pop("kind", None) != KIND:
        raise InvalidInputError(str(out), "a draft without schema and kind", "both")
    with TemporaryDirectory() as folder:
        path = given.path.resolve()
        if given.text:
            path = Path(folder) / "model.xml"
            path.write_text(given.text)
        rig = Rig.of(RigDescription.model_validate({**content, "model": str(path)}), Path(folder))
        _ = rig.model
    return rig


def _first_part(rig: Rig, log: Path) -> Recording:
    """The stretch of a log that is predicted."""
    recording = read_rig_recording(log, rig)
    rows = recording.time - recording.time[0] <= LONGEST
    signals = {name: values[rows] for name, values in recording.signals.items()}
    return Recording(recording.time[rows], signals, recording.info)


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
        taken = f"{sign}{match.spot.label} [{unit}], {way} as {signal_name(match)}"
        found.append(Guess(match.column, taken, ", ".join(match.reasons), "; ".join(match.others)))
    return tuple(found)
