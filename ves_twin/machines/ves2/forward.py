"""RigForward: VES II as the diagnosis sees it: set-points in, lengths, wrench and torques out."""

from __future__ import annotations

import hashlib
from collections import OrderedDict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np

from ves_twin.core.errors import EndedEarlyError, UnreachableError
from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.core.signals import SIGNALS
from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.model.forward import Channel, Excitation, Hypothesis, Parameter
from ves_twin.diagnosis.model.law_forward import LawPlace
from ves_twin.effects.law import Law, LawKind, variable_along
from ves_twin.effects.law_table import LawTable
from ves_twin.machines.ves2.declared_load import LOAD, load_in
from ves_twin.machines.ves2.law_causes import law_hypotheses, law_parameters, scaled_laws
from ves_twin.machines.ves2.law_places import PATH, law_places, path_of
from ves_twin.machines.ves2.library import (
    AXES,
    WANDER,
    hypotheses_of,
    idle_kinds,
    offset_parameters,
    parameters_of,
    ruled_out,
    table_parameters,
    wander_parameters,
    with_departures,
)
from ves_twin.machines.ves2.sensor_change import SensorChange, without_sensor_kinds
from ves_twin.machines.ves2.slow_noise import MODES, slow_modes
from ves_twin.plant.known_weight import hang_weight
from ves_twin.plant.plant import Plant
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.log_faults import logged
from ves_twin.simulator.predict import predict
from ves_twin.simulator.simulate import versions

DRIVE = ("leg.command", "arm.command", "gravity.estimate")
COMPARED = ("leg.length", "sensor.wrench", "arm.q", "arm.torque", "supply.pressure")

COLUMNS = {
    name: slice(end - SIGNALS[name].width, end)
    for name, end in zip(COMPARED, np.cumsum([SIGNALS[n].width for n in COMPARED]), strict=True)
}
"""Of each signal among the compared ones."""

NAMES = tuple(column for name in COMPARED for column in SIGNALS[name].columns)
WIDTH = len(NAMES)
"""Of what is compared; what laws depend on is kept beside it."""

WRENCH = COLUMNS["sensor.wrench"]

FORCES = ("sensor.wrench", "arm.torque")
SETTLING = 1.0
"""Rows of forces that say nothing [s]: joints that stand are held by friction as it happens, the
servo's integral against it. Two runs 1e-4 commissioning sd apart differ there by up to 10 sigma."""

KEPT = 32
"""Replays of each programme that are kept: 0.2 MB each of 10 s, and a search that begins anew at
its best point, or tells what its step is worth there, goes back by fewer."""

REPEATABLE = 1e-5
"""What a leg length is good for [m]: joints and frame give that much, far above the transducer."""


@dataclass(frozen=True)
class RigForward:
    """VES II under position control, the loop cut above the legs.

    Attributes:
        plant: the nominal rig.
        scenario: rates, leg gains and where the arm starts.
        exclude: kinds of effects that are left out of the library.
        misread: legs, from 1, whose logged lengths are not what the leg program read.
        loaded: whether every programme says what hangs on the arm.
    """

    plant: Plant
    scenario: Scenario
    exclude: frozenset[str] = frozenset()
    loaded: bool = False
    misread: tuple[int, ...] = ()

    @cached_property
    def identity(self) -> str:
        """Changes with plant, settings, library and versions; not with what programmes say."""
        parts = (self.plant.hash, _settings(self.scenario).model_dump_json(), versions())
        digest = hashlib.sha256(repr(parts).encode())
        digest.update(repr((self.parameters, self.hypotheses, self.channels)).encode())
        return digest.hexdigest()[:16]

    @property
    def drive(self) -> tuple[str, ...]:
        """Set-points of legs and arm, and the estimate that the sensor is zeroed against."""
        return (*DRIVE, LOAD.name) if self.loaded else DRIVE

    @cached_property
    def channels(self) -> tuple[Channel, ...]:
        """Measured columns with the sd that the plant's own numbers declare."""
        sds = noise_of(self.plant)
        corner = self.plant.actual.number("sensor.corner")
        return tuple(
            Channel(
                column,
                name,
                i,
                unit,
                float(sds[name][i]),
                corner if name == "sensor.wrench" else None,
                SETTLING if name in FORCES else 0.0,
            )
            for name in COMPARED
            for i, (column, unit) in enumerate(
                zip(SIGNALS[name].columns, SIGNALS[name].units, strict=True)
            )
        )

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:
        """Sizes of all effects, numbers of the table that commissioning leaves open, offsets."""
        return (
            *parameters_of(self.plant),
            *table_parameters(self.plant),
            *offset_parameters(self.plant),
            *wander_parameters(),
            *law_parameters(self.plant),
        )

    @cached_property
    def hypotheses(self) -> tuple[Hypothesis, ...]:
        """Every effect on every target that it can have.

        A length that is off in the log alone looks like a valve's null: which of the two it is
        the valve's own commands tell (`check_leg_program`), and the other is left out.
        """
        every = hypotheses_of(self.plant, self.exclude | idle_kinds(self.scenario))
        own = (h for h in every if not ruled_out(h.effect, h.target, self.misread))
        return (*own, *law_hypotheses(self.plant))

    def simulate(
        self,
        programme: Excitation,
        values: Mapping[str, float],
        refined: bool = False,
        laws: Sequence[Law] = (),
    ) -> FloatArray:
        """Channels (n, channels) that a rig with these values and laws measures, without noise.

        Gain, cross-talk and mounting of the sensor are laid over a run without them, which is kept:
        a third of the commissioning tolerances are of that kind, and cost no run of their own. So
        are faults of the recorder, and laws of readings.
        """
        return self._answer(programme, values, refined, laws)[0]

    def visited(
        self, programme: Excitation, values: Mapping[str, float], laws: Sequence[Law] = ()
    ) -> Mapping[str, FloatArray]:
        """Variables that laws depend on (n,), as simulated."""
        return self._answer(programme, values, False, laws)[1]

    def law_places(self) -> tuple[LawPlace, ...]:
        """Rods, joints of the arm, the platform, and compared columns."""
        return law_places(self.plant)

    @property
    def band(self) -> float:
        """All of it: nothing is differentiated."""
        return float("inf")

    def effort_unit(self, joint: str) -> str:
        """Joints of the arm turn, legs slide."""
        return "N" if joint.startswith("leg") else "N*m"

    def missing(
        self,
        programme: Excitation,
        values: Mapping[str, float],
        measured: Mapping[str, FloatArray],
        as_nominal: bool = False,
        laws: Sequence[Law] = (),
    ) -> None:
        """None: VES II moves by set-points, and what its valves make of them is not recorded."""

    def _answer(
        self,
        programme: Excitation,
        values: Mapping[str, float],
        refined: bool,
        laws: Sequence[Law],
    ) -> tuple[FloatArray, Mapping[str, FloatArray]]:
        """Channels (n, channels), and variables of laws (n,)."""
        load = load_in(programme)
        rig = hang_weight(self._smooth, load) if load else self._smooth
        acting = (*self.plant.laws, *scaled_laws(self.plant, values), *laws)
        plant, offsets = with_departures(rig, values)
        sensed = plant
        if self.scenario.gravity.file is None:  # else the reading is calibrated, too
            sensed, _ = with_departures(rig, without_sensor_kinds(values))
        efforts = (LawTable.of_law(law) for law in acting if law.kind is LawKind.EFFORT)
        effects = tuple(e for e in sensed.effects if not e.log)
        hardware = replace(sensed, effects=effects, told_laws=tuple(efforts))
        kept = self._kept.run(hardware, programme, self._rates(refined))
        rows, path = kept[:, :WIDTH].copy(), path_of(self.plant, programme.time, kept)
        for name, columns in COLUMNS.items():
            rows[:, columns] = logged(plant.effects, name, programme.time, rows[:, columns])
        if sensed is not plant:
            at_rest = programme.drive["gravity.estimate"][0] * float(self.scenario.gravity.zero)
            change = SensorChange.between(sensed, plant)
            rows[:, WRENCH] = change.apply(rows[:, WRENCH], at_rest)
        for law in acting:
            if law.kind is LawKind.READING:
                at = NAMES.index(law.place)
                along = (variable_along(name, path) for name in law.of)
                rows[:, at] = law.read(rows[:, at], *along)
        rows[:, WRENCH] += offsets + self._wander(programme, values)
        return rows, path

    def _wander(self, programme: Excitation, values: Mapping[str, float]) -> FloatArray:
        """The sensor's slow noise [N, N m] (n, 6), or zeros (6,) where its modes have no weight."""
        weights = np.array(
            [
                [values.get(f"{WANDER}{axis}.{mode + 1}", 0.0) for axis in AXES]
                for mode in range(MODES)
            ]
        )
        if not weights.any():
            return np.zeros(6)
        parameters = self.plant.parameters
        shapes = slow_modes(programme.time, parameters.number("sensor.wander_time"))
        return np.asarray(shapes @ weights * parameters.array("sensor.wander"))

    @cached_property
    def _smooth(self) -> Plant:
        """The rig without counts: its noise hides them, and without noise legs hunt over one."""
        counts = ("transducer.resolution", "sensor.resolution", "arm.encoder_resolution")
        none = {name: 0.0 * self.plant.parameters.array(name) for name in counts}
        return self.plant.with_values(none)

    def _rates(self, refined: bool) -> Scenario:
        if not refined:
            return self.scenario
        substeps = 2 * self.scenario.run.substeps
        run = self.scenario.run.model_copy(update={"substeps": substeps})
        return self.scenario.model_copy(update={"run": run})

    @cached_property
    def _kept(self) -> KeptRuns:
        return KeptRuns()


class KeptRuns:
    """The last replays of each programme: searches that begin anew ask again for what was run."""

    def __init__(self) -> None:
        self._kept: dict[str, OrderedDict[tuple[str, str], FloatArray]] = {}

    def __reduce__(self) -> tuple[Callable[[], KeptRuns], tuple[()]]:
        return _kept_here, ()  # other processes run for themselves, and keep what they ran

    def run(self, plant: Plant, programme: Excitation, scenario: Scenario) -> FloatArray:
        """COMPARED and PATH (n, all) of a plant, not to be written to; NaN if it fails."""
        asked = plant.hash, scenario.model_dump_json()
        kept = self._kept.setdefault(programme.identity, OrderedDict())
        if asked in kept:
            kept.move_to_end(asked)
            return kept[asked]
        info = RecordingInfo("measured")
        fed = {name: programme.drive[name] for name in DRIVE}
        recording = Recording(programme.time - programme.time[0], fed, info)
        try:
            answer = predict(recording, plant, scenario, DRIVE, (*COMPARED, *PATH))
            rows = np.concatenate([answer[name] for name in (*COMPARED, *PATH)], axis=1)
        except (EndedEarlyError, UnreachableError):
            width = sum(len(SIGNALS[name].columns) for name in (*COMPARED, *PATH))
            rows = np.full((len(programme.time), width), np.nan)
        kept[asked] = rows
        while len(kept) > KEPT:
            kept.popitem(last=False)
        return rows


@lru_cache(maxsize=1)
def _kept_here() -> KeptRuns:
    """Of a process that works for another one: each job comes with a forward of its own."""
    return KeptRuns()


def _settings(scenario: Scenario) -> Scenario:
    """Rates, leg program, sensor and start: a scenario without what set-points replace."""
    run = scenario.run.model_copy(update={"duration": 1.0, "seed": 0, "log": "admittance"})
    arm = scenario.arm.model_copy(update={"moves": (), "path": None, "operator": None})
    platform = scenario.platform.model_copy(update={"motion": None})
    parts = {"name": "", "question": "", "run": run, "arm": arm, "platform": platform}
    return scenario.model_copy(update=parts)


def noise_of(plant: Plant) -> dict[str, FloatArray]:
    """Declared sd of one sample of every compared signal."""
    array, number = plant.parameters.array, plant.parameters.number
    counts = array("arm.encoder_resolution") / np.sqrt(12.0)
    wrench = np.hypot(array("sensor.noise"), array("sensor.resolution") / np.sqrt(12.0))
    return {
        "leg.length": np.full(6, np.hypot(number("transducer.noise"), REPEATABLE)),
        "sensor.wrench": wrench,
        "arm.q": counts,
        "arm.torque": array("arm.torque_noise"),
        "supply.pressure": np.array([number("supply.noise")]),
    }
