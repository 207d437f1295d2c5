"""Ves2Case: a recording of VES II with its scenario, plant, noise and prediction."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ves_twin.core.errors import EndedEarlyError, InvalidInputError, UnknownNameError
from ves_twin.core.recording.even_clock import FEWEST, WAKE, even_clock, holes
from ves_twin.core.recording.recording import Recording
from ves_twin.core.signals import SIGNALS, Signal
from ves_twin.core.types import FloatArray
from ves_twin.data.quality.gate import quality_gate
from ves_twin.diagnosis.record.residuals.noise import Noise
from ves_twin.effects.law import held_words, variable_along
from ves_twin.machines.case import Case, Traces
from ves_twin.machines.ves2.declared_noise import declared_noise
from ves_twin.machines.ves2.emulation_cost import EmulationCost, emulation_cost
from ves_twin.machines.ves2.law_places import PATH, path_of
from ves_twin.machines.ves2.leg_program_check import check_leg_program
from ves_twin.machines.ves2.loop_noise import with_loop_noise
from ves_twin.plant.plant import Plant
from ves_twin.plant.rig_laws import READ
from ves_twin.scenario.experiment import COMPARED, Experiment, StartState
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.predict import predict
from ves_twin.simulator.replay import replay_scenario

POSE = "platform.pose"

END = 10
"""Cycles at the end that are not compared: the arm's spline needs commands of two cycles ahead, and
what is taken for them dies away by 0.27 a cycle towards the begin."""

COUNTS = {"m": 2e-6, "rad": 2e-5}
"""Set-points of one programme may differ by so much: four counts of a transducer, a fifth of one of
an encoder."""

LEADERS = {
    "leg.length": "leg.command",
    "valve.command": "leg.command",
    "arm.q": "arm.command",
    "arm.torque": "arm.command",
}
"""Signal -> the command whose columns lead its own, one to one."""


@dataclass(frozen=True, kw_only=True)
class Ves2Case(Case):
    """Replayed by a scenario, the loop cut above the legs.

    Attributes:
        scenario: it is replayed by.
        plant: that is tried.
    """

    scenario: Scenario
    plant: Plant

    @property
    def machine(self) -> str:
        """Of the plant."""
        return self.plant.name

    @property
    def identity(self) -> str:
        """Of the plant."""
        return self.plant.hash

    @property
    def mode(self) -> str:
        """Set-points, closed loop."""
        return "reference"

    @property
    def signals(self) -> Mapping[str, Signal]:
        """Those that every recording of VES II has."""
        return SIGNALS

    @property
    def same(self) -> Mapping[str, FloatArray]:
        """Set-points within COUNTS; the gravity estimate, which follows the run, is left out."""
        return {
            name: np.array([COUNTS[unit] for unit in SIGNALS[name].units])
            for name in self.inputs
            if name != "gravity.estimate"
        }

    @property
    def leaders(self) -> Mapping[str, str]:
        """Commands of legs and arm."""
        return {name: lead for name, lead in LEADERS.items() if lead in self.inputs}

    @property
    def beside(self) -> tuple[str, ...]:
        """The pose, for the cost of an emulation."""
        return (POSE,)

    def simulated(self) -> Traces:
        """What the plant would have measured, and the pose where the recording has one."""
        extra = [POSE] if POSE in self.recording.signals and POSE not in self.outputs else []
        asked = [*self.outputs, *extra]
        return predict(self.recording, self.plant, self.scenario, self.inputs, asked)

    def declared_noise(self) -> dict[str, Noise]:
        """What the plant's numbers say, and what the loops make of it at rest."""
        declared = declared_noise(self.plant, self.scenario, self.period)
        position = replay_scenario(self.recording, self.scenario)
        return with_loop_noise(declared, self.plant, position, self.period)

    def load(self, measured: Traces) -> FloatArray | None:
        """Size of the force on the sensor."""
        wrench = measured.get("sensor.wrench")
        return None if wrench is None else np.asarray(np.linalg.norm(wrench[:, :3], axis=1))

    def cost(self, time: FloatArray, measured: Traces, expected: Traces) -> EmulationCost | None:
        """Of wrench and pose, where the scenario emulates."""
        name = self.scenario.platform.emulated
        if name is None or "sensor.wrench" not in self.outputs:
            return None
        pose = measured[POSE] - expected[POSE] if POSE in measured and POSE in expected else None
        attitude = measured.get("platform.command", measured.get(POSE, np.zeros((len(time), 6))))
        wrench = measured["sensor.wrench"] - expected["sensor.wrench"]
        known = np.where(np.isfinite(attitude), attitude, 0.0)[:, 3:]
        return emulation_cost(name, self.plant, time, wrench, known, pose)


def ves2_case(
    name: str,
    recording: Recording,
    experiment: Experiment,
    plant: Plant | None,
    standstill: Recording | None,
) -> Ves2Case:
    """Put a recording and what is known of it together.

    Args:
        name: for people.
        recording: measured or simulated.
        experiment: how it was made.
        plant: that is tried; the experiment's or the scenario's if None.
        standstill: that the experiment names.

    Raises:
        UnknownNameError: a signal that is asked for and not there.
        InvalidInputError: no scenario, too few rows, or holes in the set-points.
    """
    scenario = experiment.scenario_of(recording)
    inputs = experiment.drive_of(recording)
    wanted = experiment.compare or COMPARED
    outputs = tuple(n for n in wanted if n in recording.signals)
    if not outputs:
        raise UnknownNameError("signal in the recording", wanted[0], recording.signals)
    rig = experiment.rig(plant, scenario)
    even = even_clock(recording, inputs)
    weight = float(rig.parameters.array("arm.mass").sum() * rig.parameters.number("gravity"))
    full_speed = rig.parameters.number("hydraulics.full_speed")
    program = check_leg_program(recording, scenario.legs, full_speed)
    return Ves2Case(
        name=name,
        recording=even,
        scenario=scenario,
        plant=rig,
        inputs=inputs,
        outputs=outputs,
        absent=tuple(n for n in wanted if n not in recording.signals),
        checks=(*quality_gate(recording, weight).checks, program),
        notes=(*_notes(recording, even, inputs, experiment), *_held(even, rig, scenario, inputs)),
        rows=_rows(even.time, scenario, experiment),
        offset=float(recording.time[0]),
        standstill=standstill,
        still=experiment.noise == "auto",
    )


def _rows(time: FloatArray, scenario: Scenario, experiment: Experiment) -> slice:
    start = experiment.window.start
    if experiment.start.state is StartState.ESTIMATED:
        start = max(start, experiment.start.forget)
    tail = END / scenario.platform.rate
    stop = min(experiment.window.stop, float(time[-1]) - tail)
    first, last = np.searchsorted(time, [start - 1e-9, stop - 1e-9])
    if last - first < FEWEST:
        came = f"{max(last - first, 0)} rows between {start:.3g} and {stop:.3g} s"
        raise InvalidInputError("window", came, f"at least {FEWEST} rows")
    return slice(int(first), int(last))


def _held(even: Recording, plant: Plant, scenario: Scenario, inputs: tuple[str, ...]) -> list[str]:
    """Where the motion leaves the range in which a law was seen, beyond which it is held."""
    if not plant.laws:
        return []
    try:
        answer = predict(even, plant, scenario, inputs, (*READ, *PATH))
    except EndedEarlyError:
        return []  # the comparison says so
    kept = np.concatenate([answer[name] for name in (*READ, *PATH)], axis=1)
    along = path_of(plant, even.time, kept)
    shares = {law: law.beyond(*(variable_along(v, along) for v in law.of)) for law in plant.laws}
    return [held_words(law, share) for law, share in shares.items() if share > 0.0]


def _notes(
    recording: Recording, even: Recording, drive: tuple[str, ...], experiment: Experiment
) -> tuple[str, ...]:
    notes = []
    lost = len(even) - len(recording)
    if lost > 0:
        notes.append(f"{lost} rows are missing from the clock and were left empty")
    bad = holes(recording, drive)
    if bad or lost > 0:
        notes.append(
            f"set-points of {bad + max(lost, 0)} rows were drawn across holes; what was measured"
            f" there and for {WAKE:g} s after is not compared"
        )
    if experiment.start.state is StartState.ESTIMATED:
        notes.append(
            f"begins in motion: started at rest, the first {experiment.start.forget:g} s are"
            " not compared"
        )
    if "arm.command" not in drive:
        notes.append("no set-points of the arm: it is taken to stand")
    if "gravity.estimate" not in drive:
        notes.append("no gravity estimate: the sensor is taken to be zeroed against none")
    return tuple(notes)
