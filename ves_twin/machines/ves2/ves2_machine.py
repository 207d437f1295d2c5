"""Ves2Machine: VES II as a machine: a plant, and the rates and gains that recordings name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.mjcf_export import MjcfExport
from ves_twin.core.recording.files import is_recording, load_recording
from ves_twin.core.recording.recording import Recording
from ves_twin.core.signals import SIGNALS, Signal
from ves_twin.data.formats.open_log import open_log
from ves_twin.data.import_log import import_log
from ves_twin.data.mapping.import_map import ImportMap
from ves_twin.data.quality.check import Check
from ves_twin.data.suspicions import Range
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.verdict.refusal import refusal
from ves_twin.diagnosis.verdict.verdict import Verdict
from ves_twin.effects.registry import causes_of_today
from ves_twin.machines.case import Case
from ves_twin.machines.claimed_law import claimed_laws
from ves_twin.machines.data_folder import find_data
from ves_twin.machines.drawing import Drawing
from ves_twin.machines.machine import Machine, Material, Named, Prepared
from ves_twin.machines.ves2.account import account
from ves_twin.machines.ves2.applied import applied
from ves_twin.machines.ves2.case import ves2_case
from ves_twin.machines.ves2.declared_load import LOAD, loads_of
from ves_twin.machines.ves2.design_space import LEAST, MOST, Ves2DesignSpace
from ves_twin.machines.ves2.drawn import drawn
from ves_twin.machines.ves2.effects_of import effects_of
from ves_twin.machines.ves2.excitations import offered_programmes
from ves_twin.machines.ves2.filter_place import EFFECT as FILTER_PLACE
from ves_twin.machines.ves2.filter_place import WithFilterPlaces
from ves_twin.machines.ves2.forward import DRIVE, RigForward
from ves_twin.machines.ves2.inputs import SORTS, check_settings, one_step, prepare_inputs
from ves_twin.machines.ves2.law_causes import named_laws
from ves_twin.machines.ves2.leg_program_check import misread_legs
from ves_twin.machines.ves2.next_scenario import write_next_experiment
from ves_twin.plant.mjcf_export import mjcf_of
from ves_twin.plant.plant import Plant
from ves_twin.plant.signal_ranges import signal_ranges
from ves_twin.plant.write_plant import write_plant
from ves_twin.scenario.experiment import COMPARABLE, Experiment
from ves_twin.scenario.experiment_file import BY_NUMBERS, ExperimentFile
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.outcome import Outcome
from ves_twin.simulator.replay import replay_scenario
from ves_twin.simulator.simulate import simulate

DIAGNOSED = frozenset({"measured", "held_out"})
"""Sorts of recordings whose recorder may be at fault; what others say of the rig must be true."""

USUAL = "identify_fast"
"""Scenario that is planned where nobody names one."""


@dataclass(frozen=True)
class Ves2Machine(Machine):
    """VES II under position control, the loop cut above the legs.

    Attributes:
        plant: the nominal rig; None: the one that recordings, or their experiment, name.
        scenario: rates, leg gains and start; None: those of the recordings.
        loaded: whether every recording says what hangs on the arm.
        misread: legs, from 1, whose logged lengths are not what the leg program read.
        mapping: which column of a lab file is which signal; None: recordings of ours.
        folder: of recordings that are not found by their path.
    """

    plant: Plant | None = None
    scenario: Scenario | None = None
    loaded: bool = False
    misread: tuple[int, ...] = ()
    mapping: ImportMap | None = None
    folder: str | None = None

    @property
    def name(self) -> str:
        """Of the plant."""
        return self.plant.name if self.plant else "VES II as it was recorded"

    @property
    def identity(self) -> str:
        """Of the plant."""
        return self._rig.hash

    @property
    def signals(self) -> Mapping[str, Signal]:
        """Measurements and the valve command."""
        return {name: SIGNALS[name] for name in COMPARABLE}

    @property
    def ranges(self) -> Mapping[str, Range]:
        """By the plant's strokes and ranges."""
        return signal_ranges(self._rig)

    @property
    def own_signals(self) -> Sequence[Signal]:
        """None beside the table of all."""
        return ()

    @cached_property
    def forward(self) -> WithFilterPlaces:
        """With the places where the leg program may filter."""
        if self.scenario is None:
            raise InvalidInputError("VES II", "no rates and gains", "a recording, or an experiment")
        return WithFilterPlaces(
            RigForward(self._rig, self.scenario, loaded=self.loaded, misread=self.misread)
        )

    def read(self, source: str) -> Recording:
        """A recording of ours, or a lab file by the map."""
        path = Path(source)
        if not path.is_dir() and (self.folder or self.mapping):
            path = find_data(source, (), self.folder)
        if self.mapping is None or is_recording(path):
            return load_recording(path)
        return import_log(open_log(path), self.mapping, plausible=self.ranges).recording

    def experiment(self, path: str | Path) -> Experiment:
        """With the keys of VES II."""
        return Experiment.load(path)

    def prepare(self, material: Material, experiment: ExperimentFile | None = None) -> Prepared:
        """Through the gate and on even clocks; set-points that were not recorded are filled in."""
        plant, scenario = self.plant, self.scenario
        if experiment is not None:
            told = _of_ves2(experiment)
            source = told.noise_source([one.name for one in material.told])
            if source and material.standstill is None:
                material = replace(material, standstill=self.read(source))
            ready, plant, scenario = applied(material.told, told, plant)
            material = material.with_told(ready)
        else:
            for one in material.measured:
                _check_inputs(one)
        first = material.measured[0].recording
        plant = plant or Plant.load(first.info.plant_base or "ves2")
        flaws: list[Check] = []
        for sort, word in SORTS.items():
            own = [one.recording for one in getattr(material, sort)]
            made = prepare_inputs(own, plant, word, scenario, misread=sort in DIAGNOSED)
            material = material.with_sort(sort, made.recordings)
            flaws += made.flaws
        setting = one_step(replay_scenario(material.measured[0].recording, scenario))
        if scenario is None:
            check_settings([one.recording for one in material.every], setting)
        loaded = any(LOAD.name in one.recording.signals for one in material.every)
        if loaded:
            for sort in SORTS:
                carried = tuple(one.recording for one in getattr(material, sort))
                material = material.with_sort(sort, loads_of(carried))
        misread = misread_legs(flaws)
        machine = replace(self, plant=plant, scenario=setting, loaded=loaded, misread=misread)
        return Prepared(machine, material, tuple(flaws))

    def cases(self, given: Named, experiment: ExperimentFile | None = None) -> tuple[Case, ...]:
        """Set-points fed in, everything measured compared."""
        told = _of_ves2(experiment or Experiment()).of(given.name)
        standstill = None if told.noise in BY_NUMBERS else self.read(told.noise)
        return (ves2_case(given.name, given.recording, told, self.plant, standstill),)

    def split(self, recording: Recording, length: float) -> tuple[list[Recording], list[Recording]]:
        """Refused: a stretch of a run begins in motion, and VES II is replayed from rest."""
        raise InvalidInputError(
            "--alternate", "VES II", "whole recordings; --held-out names others"
        )

    def settings(self, settings: Settings, excitation: Excitation) -> Settings:
        """Null rigs from the linearisation, and a sparse bank: it has 200 parameters."""
        return replace(settings, simulated_nulls=False, sparse=True)

    def extended(self, verdict: Verdict) -> Ves2Machine | None:
        """With the effects that are named, and laws; a filter's place is no part of a plant."""
        effects = effects_of(verdict)
        laws = [*named_laws(self._rig, verdict), *claimed_laws(verdict)]
        if not (effects or laws):
            return None
        return replace(self, plant=self._rig.extended(*effects).with_laws(*laws))

    def causes(self, names: Sequence[str]) -> list[str]:
        """As files of earlier versions name them, too."""
        return causes_of_today(names)

    def refusal(self, verdict: Verdict) -> str:
        """As for any machine, and where the leg program is the cause."""
        places = [cause.target for cause in verdict.causes if cause.effect == FILTER_PLACE]
        if places:
            return f'no plant has the leg program: run scenarios with legs.filter = "{places[0]}"'
        return refusal(verdict)

    def save(self, path: Path, note: str = "") -> None:
        """As a plant file."""
        write_plant(self._rig, path, note)

    def account(self) -> Mapping[str, object]:
        """Of the plant."""
        return account(self._rig)

    def mjcf(self, folder: Path) -> MjcfExport:
        """The rig at home, its legs' motors at rest; it has no meshes to find."""
        return mjcf_of(self._rig)

    def excitations(self, like: Recording | None = None) -> tuple[Excitation, ...]:
        """The menu, within stroke, speed and wrench limits, at the rates of this machine."""
        return offered_programmes(self._rig, self.scenario or Scenario.load(USUAL))

    def excitation(
        self, name: str = "", seconds: float | None = None
    ) -> tuple[Machine, Excitation]:
        """The set-points that a scenario gives.

        Under position control they are those of every rig; where a controller makes them of what
        it measures, they are those of this plant.
        """
        scenario = Scenario.load(name or USUAL)
        if seconds is not None and seconds > scenario.run.duration:
            scenario = Scenario.load(name or USUAL, {"run.duration": seconds})
        plant = self.plant or Plant.load(scenario.plant)
        recording = simulate(scenario, plant=plant)
        if recording.info.outcome != Outcome.COMPLETED:
            what = f"scenario {scenario.name}"
            raise InvalidInputError(what, recording.info.outcome, "a run that is completed")
        fed = replace(self, plant=plant, scenario=one_step(replay_scenario(recording)))
        return fed, Excitation.of(recording, DRIVE, scenario.name)

    def design_space(self, seconds: float) -> Ves2DesignSpace:
        """Multisines of the platform with moves of the arm, at the rates of this machine."""
        if not LEAST <= seconds <= MOST:
            raise InvalidInputError("seconds", seconds, f"{LEAST:g} to {MOST:g}")
        return Ves2DesignSpace(self._rig, self.scenario or Scenario.load(USUAL), seconds)

    def drawing(self) -> Drawing:
        """By leg lengths and joint angles."""
        return drawn(self._rig)

    def save_excitation(self, excitation: Excitation, folder: Path) -> None:
        """Set-points, and a scenario that plays them."""
        scenario = self.scenario or Scenario.load(USUAL)
        write_next_experiment(excitation, scenario, self._rig, folder)

    @property
    def _rig(self) -> Plant:
        return self.plant or Plant.load("ves2")


def _of_ves2(experiment: ExperimentFile) -> Experiment:
    if not isinstance(experiment, Experiment):
        raise InvalidInputError("experiment", type(experiment).__name__, "one with VES II")
    return experiment


def _check_inputs(one: Named) -> None:
    """A recording without an experiment file has all that the rig was told."""
    missing = [signal for signal in DRIVE if signal not in one.recording.signals]
    if missing:
        wanted = "what the rig was told, or an --experiment file that says it"
        raise InvalidInputError(one.name, f"no {missing[0]}", wanted)
