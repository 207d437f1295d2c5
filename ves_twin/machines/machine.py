"""Machine: what recordings are held against: VES II, an MJCF machine, poses at rest."""

from __future__ import annotations

import importlib
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from ves_twin.core.mjcf_export import MjcfExport
from ves_twin.core.recording.recording import Recording
from ves_twin.core.signals import Signal
from ves_twin.data.quality.check import Check
from ves_twin.data.suspicions import Range
from ves_twin.diagnosis.experiment.design import DesignSpace
from ves_twin.diagnosis.model.forward import Excitation, Forward
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.verdict.refusal import refusal
from ves_twin.diagnosis.verdict.verdict import Verdict
from ves_twin.machines.case import Case
from ves_twin.machines.drawing import Drawing
from ves_twin.scenario.experiment_file import ExperimentFile

SETPOINTS, SCENARIO = "next_experiment.csv", "next_experiment.toml"
"""Files of a proposed experiment; not every machine has the second."""


@dataclass(frozen=True)
class Named:
    """A recording and what it is called."""

    name: str
    recording: Recording


@dataclass(frozen=True)
class Material:
    """Recordings of one machine, by what they are for.

    Attributes:
        measured: together one record, to be explained.
        held_out: others, on which an extension must prove itself.
        baseline: of the machine in order, with the same inputs.
        commissioning: of machines in order, or of this one mounted anew.
        standstill: tells the noise; None if nobody named one.
    """

    measured: tuple[Named, ...]
    held_out: tuple[Named, ...] = ()
    baseline: tuple[Named, ...] = ()
    commissioning: tuple[Named, ...] = ()
    standstill: Recording | None = None

    @property
    def told(self) -> tuple[Named, ...]:
        """Those that an experiment file may speak of."""
        return (*self.measured, *self.held_out, *self.baseline)

    @property
    def every(self) -> tuple[Named, ...]:
        """All but the standstill."""
        return (*self.measured, *self.held_out, *self.commissioning, *self.baseline)

    def with_sort(self, sort: str, recordings: Sequence[Recording]) -> Material:
        """The same with others in place of those of one sort."""
        pairs = zip(getattr(self, sort), recordings, strict=True)
        new = tuple(replace(one, recording=recording) for one, recording in pairs)
        return replace(self, **{sort: new})  # type: ignore[arg-type]  # no sort is `standstill`

    def with_told(self, recordings: Sequence[Recording]) -> Material:
        """The same with others in place of `told`, in that order."""
        first, second = len(self.measured), len(self.measured) + len(self.held_out)
        found = self.with_sort("measured", recordings[:first])
        found = found.with_sort("held_out", recordings[first:second])
        return found.with_sort("baseline", recordings[second:])


@dataclass(frozen=True)
class Prepared:
    """A machine as it was in an experiment, and the recordings made ready for its `forward`.

    Attributes:
        machine: with the parameters, the payload and the start of the experiment.
        material: on even clocks, without what is not to be compared.
        flaws: checks of the data that failed without being a reason to refuse.
    """

    machine: Machine
    material: Material
    flaws: tuple[Check, ...] = ()

    def split(self, length: float) -> Prepared:
        """Every second stretch of the measured recordings held out; see `Machine.split`."""
        fitted: list[Named] = []
        held = list(self.material.held_out)
        for one in self.material.measured:
            kept, left = self.machine.split(one.recording, length)
            fitted += [replace(one, recording=recording) for recording in kept]
            held += [replace(one, recording=recording) for recording in left]
        return replace(
            self, material=replace(self.material, measured=tuple(fitted), held_out=tuple(held))
        )

    def in_pieces(self) -> Prepared:
        """Recordings as they are simulated; see `Machine.pieces`.

        Of a machine that is in order its first piece alone: each recording counts as one machine.
        """

        def cut(given: Sequence[Named]) -> tuple[Named, ...]:
            pairs = ((one, self.machine.pieces(one.recording)) for one in given)
            return tuple(replace(one, recording=piece) for one, parts in pairs for piece in parts)

        told = self.material
        first = [self.machine.pieces(one.recording)[0] for one in told.commissioning]
        material = replace(
            told.with_sort("commissioning", first),
            measured=cut(told.measured),
            held_out=cut(told.held_out),
            baseline=cut(told.baseline),
        )
        return replace(self, material=material)


class Machine(ABC):
    """What compare, diagnose, trend and plan need of a machine, and nothing else they ask."""

    @staticmethod
    def load(name_or_path: str = "") -> Machine:
        """A machine by the name of a shipped one, or by its file; see `open_machine`."""
        loader = importlib.import_module("ves_twin.machines.load")  # which imports this file
        machine: Machine = loader.open_machine(name_or_path)
        return machine

    @property
    @abstractmethod
    def name(self) -> str:
        """For people."""

    @property
    @abstractmethod
    def identity(self) -> str:
        """Changes with anything that changes a prediction."""

    @property
    @abstractmethod
    def signals(self) -> Mapping[str, Signal]:
        """What may be compared, by name."""

    @property
    @abstractmethod
    def ranges(self) -> Mapping[str, Range]:
        """Least and largest plausible value of each column, by signal, where they are known."""

    @property
    @abstractmethod
    def own_signals(self) -> Sequence[Signal]:
        """Signals that an import map may name without declaring them, beside those of VES II."""

    @property
    @abstractmethod
    def forward(self) -> Forward:
        """The machine as the diagnosis sees it.

        Raises:
            InvalidInputError: a machine that only its recordings, or an experiment, make whole.
        """

    @abstractmethod
    def read(self, source: str) -> Recording:
        """A recording of it from whatever it lies in.

        Raises:
            VesTwinError: a file that is missing, or does not hold what the machine needs.
        """

    @abstractmethod
    def experiment(self, path: str | Path) -> ExperimentFile:
        """How recordings of it were made, from a TOML file.

        Raises:
            VesTwinError: missing, or with a key, name or unit that this machine does not have.
        """

    @abstractmethod
    def prepare(self, material: Material, experiment: ExperimentFile | None = None) -> Prepared:
        """Make recordings ready for the diagnosis, through the quality gate, as one experiment.

        Raises:
            VesTwinError: recordings that cannot be what they say, or of machines that differ.
        """

    @abstractmethod
    def cases(self, given: Named, experiment: ExperimentFile | None = None) -> tuple[Case, ...]:
        """A recording ready to be compared, in every mode in which the machine can be fed."""

    @abstractmethod
    def split(self, recording: Recording, length: float) -> tuple[list[Recording], list[Recording]]:
        """Every second stretch of a length [s, poses; 0: the machine's own], and those between.

        Raises:
            InvalidInputError: fewer than two stretches, or a machine whose recordings cannot be
                cut, since a stretch does not say how it begins.
        """

    def pieces(self, recording: Recording) -> Sequence[Recording]:
        """Parts of a recording that are simulated each from a start of its own; one: all of it.

        Raises:
            InvalidInputError: a machine of which no row tells how a part begins.
        """
        return (recording,)

    @abstractmethod
    def extended(self, verdict: Verdict) -> Machine | None:
        """The machine with the causes of a verdict; None where they are no part of it."""

    @abstractmethod
    def save(self, path: Path, note: str = "") -> None:
        """Write a file that loads again, with a note at its head.

        Raises:
            FileAccessError: not writable.
        """

    @abstractmethod
    def account(self) -> Mapping[str, object]:
        """What it is and what differs from its nominal model, by title, for people and JSON."""

    @abstractmethod
    def mjcf(self, folder: Path) -> MjcfExport:
        """What one MJCF file can carry of it.

        Args:
            folder: that the file will lie in, from which it finds meshes.

        Raises:
            InvalidInputError: numbers that no rigid body can have.
        """

    def as_mjcf(self) -> tuple[Machine | None, tuple[str, ...]]:
        """The machine that its MJCF file is, and what that lacks; None where it lacks nothing.

        Raises:
            InvalidInputError: as `mjcf`.
        """
        return None, ()

    @abstractmethod
    def excitations(self, like: Recording | None = None) -> Sequence[Excitation]:
        """What the machine could be fed next, within its limits.

        Args:
            like: a recording whose clock and start they take; the machine's own if None.
        """

    @abstractmethod
    def excitation(
        self, name: str = "", seconds: float | None = None
    ) -> tuple[Machine, Excitation]:
        """What is fed in by a scenario, an offered excitation or a recording, and who is fed.

        Args:
            name: of it; the machine's first choice if empty.
            seconds: at least so long, where the machine can be asked for longer.

        Raises:
            VesTwinError: no such excitation, or one that the machine does not carry out.
        """

    @abstractmethod
    def design_space(self, seconds: float) -> DesignSpace:
        """Excitations of a length [s] within the machine's limits, from which one is designed.

        Raises:
            InvalidInputError: inputs that cannot be bounded.
        """

    @abstractmethod
    def save_excitation(self, excitation: Excitation, folder: Path) -> None:
        """Write it as `SETPOINTS`, and as `SCENARIO` where the machine runs scenarios.

        Raises:
            FileAccessError: not writable.
        """

    def further(self) -> Forward:
        """The machine with every channel that it could have, its own first, in their order."""
        return self.forward

    def drawing(self) -> Drawing | None:
        """Its bodies, for pictures; None where its recordings do not say where they are."""
        return None

    def settings(self, settings: Settings, excitation: Excitation) -> Settings:
        """Settings as the size of this machine makes sensible.

        Args:
            settings: as they were asked for.
            excitation: one that will be simulated many times.
        """
        return settings

    def causes(self, names: Sequence[str]) -> list[str]:
        """Causes, each a kind or kind@target, by the kinds' names of today."""
        return list(names)

    def refusal(self, verdict: Verdict) -> str:
        """Why the extension is only a candidate; empty where it passed."""
        return refusal(verdict)
