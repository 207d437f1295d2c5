"""Drafting: versions of a draft of one log, and the one that explains most of it."""

from __future__ import annotations

import os
import tomllib
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from tempfile import TemporaryDirectory

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.recording import Recording
from ves_twin.machines.mjcf.draft.check import Checked, checked
from ves_twin.machines.mjcf.draft.chosen import Chosen, chosen
from ves_twin.machines.mjcf.draft.commanded import as_commanded
from ves_twin.machines.mjcf.draft.draft_text import draft_text
from ves_twin.machines.mjcf.draft.given_model import GivenModel
from ves_twin.machines.mjcf.draft.log_columns import LogColumns
from ves_twin.machines.mjcf.draft.match import Matches
from ves_twin.machines.mjcf.draft.other_way import other_way
from ves_twin.machines.mjcf.draft.predicted import AWAY, FEWEST, predicted
from ves_twin.machines.mjcf.draft.runs_away import runs_away
from ves_twin.machines.mjcf.draft.unmeasured import unmeasured
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.recordings.columns import read_rig_recording
from ves_twin.machines.mjcf.rig.description import KIND, Mode, RigDescription
from ves_twin.machines.mjcf.rig.machine import Rig

HALF = 0.5
"""Share of a signal that a model must explain open loop for commands to be fed in: an arm that
drifts off its path tells nothing."""

ROWS = 150
"""Rows of the analysis in a piece: half as many again as a diagnosis asks for."""

LONGEST = 60.0
"""Stretch of a log that is predicted to say how near the model is [s]."""

HORIZONS = (10.0, 5.0, 3.0, 2.0, 1.5, 1.0, 0.5)
"""Pieces that are tried where the model runs away from a log [s], the longest first."""

HELPS = 0.1
"""Share of a signal's power that a horizon must explain more for it to be taken."""


@dataclass(frozen=True)
class Version:
    """A draft in one mode, with what it explains and what its step spoils.

    Attributes:
        mode: what is fed in.
        check: columns as the model corrected them.
        text: of the file.
        rig: the machine of that text.
        log: that it was read from.
        explained: column or signal -> share of its power that the model explains.
        coarse: columns that the model's step spoils, a sentence each.
    """

    mode: Chosen
    check: Checked
    text: str
    rig: Rig
    log: Path
    explained: dict[str, float]
    coarse: list[str]

    @property
    def least(self) -> str:
        """What it explains least of."""
        return min(self.explained, key=lambda name: self.explained[name])

    @property
    def share(self) -> float:
        """Share that it explains of that; below zero where a simulation runs away."""
        return self.explained[self.least]

    @property
    def percent(self) -> str:
        """The same for people: what runs away explains nothing."""
        return f"{max(self.share, 0.0):.0%}"

    @cached_property
    def part(self) -> Recording:
        """The stretch of the log that is predicted."""
        recording = read_rig_recording(self.log, self.rig)
        rows = recording.time - recording.time[0] <= LONGEST
        signals = {name: values[rows] for name, values in recording.signals.items()}
        return Recording(recording.time[rows], signals, recording.info)

    @property
    def simulated(self) -> bool:
        """Whether motion is predicted, of rows enough to tell anything."""
        return self.mode.mode is not Mode.MOTION and len(self.part.time) >= FEWEST

    @property
    def poor(self) -> bool:
        """Whether commands are fed in, and the model explains less than HALF of something."""
        return self.mode.mode is Mode.CONTROL and self.simulated and self.share < HALF


@dataclass(frozen=True)
class Drafting:
    """What all versions of a draft share.

    Attributes:
        model: file of the model.
        path: of the log.
        out: where the file will lie: paths in it start from there.
        given: the model.
        log: its columns.
        matches: what each is taken for.
    """

    model: Path
    path: Path
    out: Path
    given: GivenModel
    log: LogColumns
    matches: Matches

    def best(self) -> Version:
        """The first version, put right step by step where it explains too little."""
        check = checked(self.log, self.matches, self.given.model)
        now = self.of(chosen(self.log, self.matches, check, self.given.model), check)
        for better in (self.with_sizes, self.as_commanded, self.with_motion, self.in_pieces):
            now = better(now)
        return now

    def of(self, mode: Chosen, check: Checked) -> Version:
        """A version in a mode, simulated where motion is predicted."""
        file = os.path.relpath(self.model, self.out.parent)
        if self.given.text:
            file = self.out.with_suffix(".xml").name
        asked = self.out.stem, self.model, file, self.log, self.matches, check, mode
        text = draft_text(*asked, self.given.model)
        rig = self._rig(text)
        if mode.mode is Mode.MOTION:
            return Version(mode, check, text, rig, self.path, dict(check.explained), [])
        plain = Version(mode, check, text, rig, self.path, {}, [])
        explained, coarse = predicted(rig, plain.part)
        return replace(plain, explained=explained, coarse=coarse)

    def with_sizes(self, now: Version) -> Version:
        """With typical sizes of joints that no column tells."""
        sizes = unmeasured(now.rig, now.part) if now.simulated else {}
        return self.of(replace(now.mode, typical=sizes), now.check) if sizes else now

    def as_commanded(self, now: Version) -> Version:
        """With the model's own commands in place of fitted constants, where that explains more."""
        control = now.mode.mode is Mode.CONTROL and now.simulated
        plain = as_commanded(now.check) if control else None
        if plain is None:
            return now
        other = self.of(now.mode, plain)
        return other if other.share > now.share else now

    def with_motion(self, now: Version) -> Version:
        """With the motion given, where that is possible and the model explains too little of it."""
        if not now.mode.either or now.share >= HALF:
            return now
        why = f"open loop the model explains {now.percent} of {now.least}"
        mode = chosen(self.log, self.matches, now.check, self.given.model, why)
        return self.of(mode, now.check)

    def in_pieces(self, whole: Version) -> Version:
        """With the longest horizon over which the model explains HALF, or that explains most.

        Of what drifts, or grows from a nudge of its start. Where no horizon helps, or no row tells
        a joint's start, all stays as it is.
        """
        if not whole.poor or not self._leaves(whole):
            return whole
        mode = whole.mode
        over = f"over the whole log the model explains {whole.percent} of {whole.least}"
        best, found = whole.share + HELPS, whole
        for horizon in self._horizons(mode):
            try:
                new = replace(mode, horizon=horizon, why=f"{mode.why}; {over}")
                cut = self.of(new, whole.check)
            except InvalidInputError:  # a joint whose start no row tells
                break
            if cut.share > best:
                best, found = cut.share, cut
            if found.share >= HALF:
                break
        return found

    def other_way(self, now: Version) -> tuple[list[str], bool]:
        """Columns that, turned or in another unit, are explained better; whether friction does so.

        A swing that runs away whole is told from its turned one in the shortest pieces.
        """
        if not now.poor:
            return [], False
        turned = other_way(now.rig, now.part)
        cut = None if turned[0] else self._shortest(now)
        return other_way(cut.rig, cut.part) if cut else turned

    def _leaves(self, whole: Version) -> bool:
        """Whether a simulation of the whole log ends far from it."""
        if whole.share < AWAY:
            return True
        return runs_away(MjcfForward.of(whole.rig), read_rig_recording(self.path, whole.rig))

    def _horizons(self, mode: Chosen) -> list[float]:
        """Pieces [s] that have ROWS of the analysis, which has no more of them than the log."""
        return [h for h in HORIZONS if h * min(mode.rate, 1.0 / self.log.period) >= ROWS]

    def _shortest(self, whole: Version) -> Version | None:
        """In the shortest pieces; None where it is in some, or no row tells a joint's start."""
        usable = self._horizons(whole.mode)
        if whole.mode.horizon or not usable:
            return None
        try:
            return self.of(replace(whole.mode, horizon=usable[-1]), whole.check)
        except InvalidInputError:
            return None

    def _rig(self, text: str) -> Rig:
        """The machine of a text, before anything is written; its model is compiled already."""
        content = tomllib.loads(text)
        if content.pop("schema", None) is None or content.pop("kind", None) != KIND:
            raise InvalidInputError(str(self.out), "a draft without schema and kind", "both")
        with TemporaryDirectory() as folder:
            path = self.given.path.resolve()
            if self.given.text:
                path = Path(folder) / "model.xml"
                path.write_text(self.given.text)
            told = RigDescription.model_validate({**content, "model": str(path)})
            rig = Rig.of(told, Path(folder))
            _ = rig.model
        return rig
