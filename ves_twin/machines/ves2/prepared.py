"""prepare: a recording on an even clock with its scenario, plant, noise and prediction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.recording.even_clock import FEWEST, WAKE, even_clock, holes
from ves_twin.core.recording.files import load_recording
from ves_twin.core.recording.recording import Recording
from ves_twin.core.signals import SIGNALS
from ves_twin.core.types import FloatArray
from ves_twin.data.quality.check import Check
from ves_twin.data.quality.gate import quality_gate
from ves_twin.diagnosis.residuals.noise import Noise, NoiseSource, measured_noise, standing_rows
from ves_twin.machines.ves2.declared_noise import declared_noise
from ves_twin.machines.ves2.loop_noise import with_loop_noise
from ves_twin.plant.plant import Plant
from ves_twin.scenario.experiment import COMPARED, Experiment, StartState
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.predict import predict
from ves_twin.simulator.replay import replay_scenario

POSE = "platform.pose"

END = 10
"""Cycles at the end that are not compared: the arm's spline needs commands of two cycles ahead, and
what is taken for them dies away by 0.27 a cycle towards the begin."""


@dataclass(frozen=True)
class Prepared:
    """A recording ready to be compared.

    Attributes:
        name: for people.
        recording: on an even clock from its first row on.
        scenario: it is replayed by.
        plant: that is tried.
        drive: signals that are fed in.
        compared: signals that are compared.
        absent: signals that are missing.
        checks: of the gate.
        notes: what was done.
        rows: those that are compared.
        offset: time of the first row in the file [s].
    """

    name: str
    recording: Recording
    scenario: Scenario
    plant: Plant
    drive: tuple[str, ...]
    compared: tuple[str, ...]
    absent: tuple[str, ...]
    checks: tuple[Check, ...]
    notes: tuple[str, ...]
    rows: slice
    offset: float

    @property
    def period(self) -> float:
        """Of the rows [s]."""
        return float(np.median(np.diff(self.recording.time)))

    def simulated(self) -> dict[str, FloatArray]:
        """What the plant would have measured, and the pose where the recording has one."""
        extra = [POSE] if POSE in self.recording.signals and POSE not in self.compared else []
        asked = [*self.compared, *extra]
        return predict(self.recording, self.plant, self.scenario, self.drive, asked)


def prepare(
    name: str, recording: Recording, experiment: Experiment, plant: Plant | None
) -> Prepared:
    """Put a recording and what is known of it together.

    Raises:
        UnknownNameError: a signal that is asked for and not there.
        InvalidInputError: no scenario, too few rows, or holes in the set-points.
    """
    scenario = experiment.scenario_of(recording)
    drive = experiment.drive_of(recording)
    wanted = experiment.compare or COMPARED
    compared = tuple(n for n in wanted if n in recording.signals)
    if not compared:
        raise UnknownNameError("signal in the recording", wanted[0], recording.signals)
    rig = experiment.rig(plant, scenario)
    even = even_clock(recording, drive)
    rows = _rows(even.time, scenario, experiment)
    notes = _notes(recording, even, drive, experiment)
    weight = float(rig.parameters.array("arm.mass").sum() * rig.parameters.number("gravity"))
    return Prepared(
        name=name,
        recording=even,
        scenario=scenario,
        plant=rig,
        drive=drive,
        compared=compared,
        absent=tuple(n for n in wanted if n not in recording.signals),
        checks=quality_gate(recording, weight).checks,
        notes=notes,
        rows=rows,
        offset=float(recording.time[0]),
    )


def noise_of_columns(prepared: Prepared, source: str) -> dict[str, Noise]:
    """Noise of each compared column: of a standstill if there is one, else declared.

    Args:
        prepared: the recording.
        source: "auto", "declared", or the file of a standstill recording.

    Raises:
        InvalidInputError: a standstill recording at another rate.
    """
    declared = declared_noise(prepared.plant, prepared.scenario, prepared.period)
    position = replay_scenario(prepared.recording, prepared.scenario)
    declared = with_loop_noise(declared, prepared.plant, position, prepared.period)
    recording, rows, said = prepared.recording, slice(0), NoiseSource.STILL
    if source not in {"auto", "declared"}:
        recording = even_clock(load_recording(source), ())
        rows, said = slice(None), NoiseSource.STANDSTILL
        period = float(np.median(np.diff(recording.time)))
        if abs(period / prepared.period - 1.0) > 0.01:
            here = f"{1.0 / prepared.period:.4g} Hz as in {prepared.name}"
            raise InvalidInputError(
                "rate of the standstill recording", f"{1 / period:.4g} Hz", here
            )
    elif source == "auto":
        rows = standing_rows(recording, prepared.drive) or slice(0)
    found = {}
    for name in prepared.compared:
        for i, column in enumerate(SIGNALS[name].columns):
            there = name in recording.signals
            values = recording[name][rows, i] if there else np.zeros(0)
            found[column] = measured_noise(values, declared[column], said)
    return found


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
