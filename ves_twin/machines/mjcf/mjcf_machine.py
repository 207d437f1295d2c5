"""MjcfMachine: an MJCF model and its TOML file as a machine."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.mjcf_export import MjcfExport
from ves_twin.core.recording.recording import POSES, Recording
from ves_twin.core.signals import Signal
from ves_twin.data.mapping.import_map import ImportMap
from ves_twin.data.quality.check import Check, Grade
from ves_twin.data.quality.gate import quality_gate
from ves_twin.data.suspicions import Range
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.diagnosis.record.preprocess import FEWEST_ROWS
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.verdict.verdict import Verdict
from ves_twin.effects.registry import causes_anywhere
from ves_twin.machines.case import Case
from ves_twin.machines.data_folder import find_data
from ves_twin.machines.drawing import Drawing
from ves_twin.machines.machine import Machine, Material, Named, Prepared
from ves_twin.machines.mjcf.inputs.design_space import MjcfDesignSpace
from ves_twin.machines.mjcf.inputs.excitations import SECONDS, offered, write_inputs
from ves_twin.machines.mjcf.inputs.further import with_further
from ves_twin.machines.mjcf.inputs.programmes import releases
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.motion.pieces import pieces
from ves_twin.machines.mjcf.motion.started import started
from ves_twin.machines.mjcf.plausible.implausible import check_plausible
from ves_twin.machines.mjcf.recordings.applied import applied
from ves_twin.machines.mjcf.recordings.case import mjcf_cases
from ves_twin.machines.mjcf.recordings.experiment import MjcfExperiment
from ves_twin.machines.mjcf.recordings.interleaved_split import alternate
from ves_twin.machines.mjcf.recordings.read import read_recording
from ves_twin.machines.mjcf.recordings.signals import rig_ranges, rig_signals, with_signals
from ves_twin.machines.mjcf.rig.account import account
from ves_twin.machines.mjcf.rig.drawn import drawn
from ves_twin.machines.mjcf.rig.extend import extended, write_rig
from ves_twin.machines.mjcf.rig.machine import Rig
from ves_twin.machines.mjcf.rig.mjcf_export import mjcf_of, rig_of_mjcf
from ves_twin.scenario.experiment_file import BY_NUMBERS, ExperimentFile

SORTS = ("measured", "held_out", "commissioning", "baseline")
"""Recordings of `Material` that begin somewhere."""

LONGEST = 600.0
"""Length of a design at most [s], as of a machine's own multisine."""

WORTH_A_PROCESS = 0.1
"""Time of one prediction [s] from which other processes pay: they take 3 s to begin, and a
diagnosis makes hundreds of predictions."""


@dataclass(frozen=True)
class MjcfMachine(Machine):
    """Any machine that MJCF and one TOML file describe.

    Attributes:
        rig: the two files.
        mapping: which column of a lab file is which signal; None: the machine's file says it.
        folder: of public data sets; that of the environment if None.
    """

    rig: Rig
    mapping: ImportMap | None = None
    folder: str | None = None

    @property
    def name(self) -> str:
        """Of the file."""
        return self.rig.description.name

    @property
    def identity(self) -> str:
        """Of both files."""
        return self.rig.identity

    @property
    def signals(self) -> Mapping[str, Signal]:
        """Those of the file's table `compare`."""
        return {s.name: s for s in self.own_signals if s.name in self.rig.description.compare}

    @property
    def ranges(self) -> Mapping[str, Range]:
        """By the typical sizes of the file."""
        return rig_ranges(self.rig)

    @property
    def own_signals(self) -> Sequence[Signal]:
        """All of the file."""
        return rig_signals(self.rig)

    @cached_property
    def forward(self) -> MjcfForward:
        """In the mode of the file."""
        return MjcfForward.of(self.rig)

    def read(self, source: str) -> Recording:
        """By the columns of the file, by the map, or by name where it was imported."""
        path = Path(source)
        if not path.is_dir():
            path = find_data(source, self.rig.description.data, self.folder)
        return read_recording(path, self.rig, self.mapping)

    def experiment(self, path: str | Path) -> MjcfExperiment:
        """With the keys of MJCF machines."""
        return MjcfExperiment.load(path)

    def prepare(self, material: Material, experiment: ExperimentFile | None = None) -> Prepared:
        """The stretches that are compared, of one machine in one state."""
        flaws = tuple(flaw for one in material.every for flaw in _flaws(one, self.rig))
        machine = self
        if experiment is not None:
            told = _of_mjcf(experiment)
            source = told.noise_source([one.name for one in material.told])
            made = [applied(one.name, one.recording, told, self.rig) for one in material.told]
            first = made[0][1]
            for one, (_, rig, _) in zip(material.told, made, strict=True):
                if rig.identity != first.identity:
                    came = "another payload, start or other parameters than the first recording"
                    expected = "one rig in all recordings of a diagnosis"
                    raise InvalidInputError(one.name, came, expected)
            if source and material.standstill is None:
                material = replace(material, standstill=self.read(source))
            material = material.with_told([recording for recording, _, _ in made])
            machine = replace(self, rig=first)
        begun, groups = started(machine.rig, *(_recordings(material, sort) for sort in SORTS))
        for sort, recordings in zip(SORTS, groups, strict=True):
            material = material.with_sort(sort, recordings)
        machine = replace(machine, rig=begun)
        check_plausible(machine.rig, [one.recording for one in material.measured])
        for one in material.measured:
            machine.forward.check_noise(one.recording.signals)
        return Prepared(machine, material, flaws)

    def cases(self, given: Named, experiment: ExperimentFile | None = None) -> tuple[Case, ...]:
        """The mode of the file, and closed loop where set-points were recorded."""
        told = _of_mjcf(experiment or MjcfExperiment())
        source = told.of(given.name).noise
        standstill = None if source in BY_NUMBERS else self.read(source)
        return mjcf_cases(given.name, given.recording, told, self.rig, standstill)

    def split(self, recording: Recording, length: float) -> tuple[list[Recording], list[Recording]]:
        """Stretches, or poses; the length of the file if zero."""
        told = self.rig.description
        return alternate(recording, length or told.block, told.rate)

    def pieces(self, recording: Recording) -> tuple[Recording, ...]:
        """Of the horizon of its file."""
        return pieces(self.rig, recording)

    def drawing(self) -> Drawing | None:
        """By the joints whose positions are compared."""
        return drawn(self.rig)

    def settings(self, settings: Settings, excitation: Excitation) -> Settings:
        """Rate and number of causes of the file; one process where a prediction is quick."""
        told = self.rig.description
        chosen = replace(settings, rate=told.rate, causes=told.causes)
        begin = perf_counter()
        self.forward.simulate(excitation, {})
        quick = perf_counter() - begin < WORTH_A_PROCESS
        return replace(chosen, workers=1) if quick else chosen

    def causes(self, names: Sequence[str]) -> list[str]:
        """As files of earlier versions name them, too."""
        return causes_anywhere(names)

    def extended(self, verdict: Verdict) -> MjcfMachine | None:
        """With the causes, and the numbers that were tuned beside."""
        return replace(self, rig=extended(self.rig, verdict))

    def save(self, path: Path, note: str = "") -> None:
        """What it has over the file that it was loaded from."""
        write_rig(self.rig, path, note)

    def account(self) -> Mapping[str, object]:
        """Of both files."""
        return account(self.rig)

    def mjcf(self, folder: Path) -> MjcfExport:
        """Its model with the numbers of its file."""
        return mjcf_of(self.rig, folder)

    def as_mjcf(self) -> tuple[MjcfMachine | None, tuple[str, ...]]:
        """By the file itself, with the log's columns and the typical sizes of this one."""
        with TemporaryDirectory() as place:
            export = mjcf_of(self.rig, Path(place))
            if not export.lost:
                return None, ()
            return replace(self, rig=rig_of_mjcf(self.rig, export.text, Path(place))), export.lost

    def excitations(self, like: Recording | None = None) -> tuple[Excitation, ...]:
        """Multisines within the typical sizes of the file, and releases."""
        return (*offered(self.forward, like), *releases(self.rig))

    def excitation(
        self, name: str = "", seconds: float | None = None
    ) -> tuple[Machine, Excitation]:
        """An offered one by its name, or what a recording says was fed in."""
        self.forward.check_noise(self.signals)
        if name and Path(name).exists():
            told = self.rig.description
            return self, Excitation.of(self.read(name), self.forward.drive, name, told.rate)
        menu = {one.name: one for one in offered(self.forward, None, max(seconds or 0.0, SECONDS))}
        if not menu:
            raise self._unbounded()
        if name and name not in menu:
            raise UnknownNameError("excitation", name, menu)
        return self, menu[name or next(iter(menu))]

    def design_space(self, seconds: float) -> MjcfDesignSpace:
        """Multisines, and starts of the joints that may be let go."""
        least = 1.2 * FEWEST_ROWS / self.rig.description.rate
        if not least <= seconds <= LONGEST:
            raise InvalidInputError("seconds", seconds, f"{least:.3g} to {LONGEST:g}")
        space = MjcfDesignSpace.of(self.forward, seconds)
        if space is None:
            raise self._unbounded()
        return space

    def _unbounded(self) -> InvalidInputError:
        came = "nothing that is within typical effort, speed and travel of its joints"
        return InvalidInputError(f"excitations of {self.name}", came, "a recording to go by")

    def further(self) -> MjcfForward:
        """With sensors of position, speed, effort, force and acceleration."""
        return with_further(self.forward)

    def save_excitation(self, excitation: Excitation, folder: Path) -> None:
        """Columns as the machine's file names and scales them."""
        write_inputs(self.forward, excitation, folder)


def _recordings(material: Material, sort: str) -> list[Recording]:
    return [one.recording for one in getattr(material, sort)]


def _of_mjcf(experiment: ExperimentFile) -> MjcfExperiment:
    if not isinstance(experiment, MjcfExperiment):
        raise InvalidInputError("experiment", type(experiment).__name__, "one with an MJCF machine")
    return experiment


def _flaws(one: Named, rig: Rig) -> list[Check]:
    if one.recording.info.log == POSES:
        return []
    report = quality_gate(with_signals(one.recording, rig))
    doubted = (c for c in report.checks if c.name == "rate" and c.grade is Grade.UNKNOWN)
    told = (*report.failures, *doubted)  # a clock in another unit makes sizes of every cause
    return [replace(check, message=f"{one.name}: {check.message}") for check in told]
