"""tell: recordings of VES II made ready for a diagnosis as an experiment file says."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.files import load_recording
from ves_twin.core.recording.recording import Recording
from ves_twin.core.recording.stretch import compared_stretch
from ves_twin.core.types import FloatArray
from ves_twin.machines.ves2.declared_load import with_load
from ves_twin.machines.ves2.forward import COMPARED, DRIVE
from ves_twin.mechanics.kinematics.stewart import leg_lengths
from ves_twin.plant.plant import Plant
from ves_twin.scenario.experiment import Experiment, StartState
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.build import belief_of


@dataclass(frozen=True)
class Told:
    """What a diagnosis needs.

    Attributes:
        recordings: in the order in which they were given.
        scenario: rates, gains and start.
        plant: the nominal rig with the numbers of the experiment, and with its payload where
            all recordings have the same; else each recording says its own.
        standstill: recording that tells the noise, if the experiment names one.
    """

    recordings: tuple[Recording, ...]
    scenario: Scenario
    plant: Plant
    standstill: Recording | None


def tell(recordings: Mapping[str, Recording], experiment: Experiment, plant: Plant | None) -> Told:
    """Apply an experiment to recordings of one rig.

    Set-points that were not recorded are filled in: lengths from poses by the inverse kinematics
    that the rig believes in, an arm that stands, no gravity estimate. What is not to be compared
    (before the window, or while a start in motion is forgotten) stays as set-points and loses its
    measurements; what comes after the window is cut.

    Args:
        recordings: by name.
        experiment: how they were made.
        plant: the nominal rig; the experiment's or the scenario's if left out.

    Raises:
        UnknownNameError: a recording that is not there, or a set-point that was not recorded.
        InvalidInputError: recordings of rigs that differ, or an empty window.
    """
    experiment.check_names(list(recordings))
    told = {name: experiment.of(name) for name in recordings}
    scenarios = {name: told[name].scenario_of(r) for name, r in recordings.items()}
    loads = {name: told[name].payload for name in recordings}
    own = len(set(loads.values())) > 1
    if own:  # each recording carries its load, and the rig none
        told = {name: t.model_copy(update={"payload": 0.0}) for name, t in told.items()}
    rigs = {name: told[name].rig(plant, scenarios[name]) for name in recordings}
    first = next(iter(recordings))
    for name in recordings:
        if rigs[name].hash != rigs[first].hash:
            came = f"another plant or other parameters than {first}"
            raise InvalidInputError(name, came, "one rig in all recordings of a diagnosis")
        if told[name].noise != told[first].noise:
            came = f"another noise source than {first}"
            raise InvalidInputError(name, came, "one noise source in a diagnosis")
    source = told[first].noise
    standstill = None if source in {"auto", "declared"} else load_recording(source)
    ready = tuple(
        _windowed(_driven(r, told[name], scenarios[name]), told[name], name)
        for name, r in recordings.items()
    )
    if own:
        ready = tuple(map(with_load, ready, loads.values()))
    return Told(ready, scenarios[first], rigs[first], standstill)


def _driven(recording: Recording, told: Experiment, scenario: Scenario) -> Recording:
    """The signals that are fed in and compared, with every set-point that a diagnosis feeds."""
    fed = told.drive_of(recording)
    signals = {name: recording[name] for name in fed if name in DRIVE}
    rows = len(recording)
    if "leg.command" not in signals:
        signals["leg.command"] = _lengths(recording["platform.command"], scenario)
    signals.setdefault("arm.command", np.tile(np.asarray(scenario.arm.start), (rows, 1)))
    signals.setdefault("gravity.estimate", np.zeros((rows, 6)))
    for name in told.compare or COMPARED:
        if name in recording.signals and name in COMPARED:
            signals[name] = recording[name]
    return replace(recording, signals=signals)


def _lengths(poses: FloatArray, scenario: Scenario) -> FloatArray:
    g = belief_of(scenario).geometry
    return np.array([leg_lengths(pose, g.base, g.top, g.home) for pose in poses])


def _windowed(recording: Recording, told: Experiment, name: str) -> Recording:
    start = told.window.start
    if told.start.state is StartState.ESTIMATED:
        start = max(start, told.start.forget)
    return compared_stretch(recording, start, told.window.stop, DRIVE, name)
