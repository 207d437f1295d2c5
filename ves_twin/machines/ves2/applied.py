"""applied: recordings of VES II with what an experiment file says of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.recording import Recording
from ves_twin.core.recording.stretch import compared_stretch
from ves_twin.core.types import FloatArray
from ves_twin.machines.machine import Named
from ves_twin.machines.ves2.declared_load import with_load
from ves_twin.machines.ves2.forward import COMPARED, DRIVE
from ves_twin.mechanics.kinematics.stewart import leg_lengths
from ves_twin.plant.plant import Plant
from ves_twin.scenario.experiment import Experiment, StartState
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.build import belief_of


def applied(
    recordings: Sequence[Named], experiment: Experiment, plant: Plant | None
) -> tuple[tuple[Recording, ...], Plant, Scenario]:
    """Apply an experiment to recordings of one rig.

    Set-points that were not recorded are filled in: lengths from poses by the inverse kinematics
    that the rig believes in, an arm that stands, no gravity estimate. What is not to be compared
    (before the window, or while a start in motion is forgotten) stays as set-points and loses its
    measurements; what comes after the window is cut.

    Args:
        recordings: of one rig.
        experiment: how they were made.
        plant: the nominal rig; the experiment's or the scenario's if left out.

    Returns:
        The recordings; the rig with the numbers of the experiment, and with its payload where all
        recordings have the same, else each recording says its own; rates, gains and start.

    Raises:
        UnknownNameError: a recording that is not there, or a set-point that was not recorded.
        InvalidInputError: recordings of rigs that differ, or an empty window.
    """
    told = [experiment.of(one.name) for one in recordings]
    scenarios = [t.scenario_of(one.recording) for t, one in zip(told, recordings, strict=True)]
    loads = [t.payload for t in told]
    own = len(set(loads)) > 1
    if own:  # each recording carries its load, and the rig none
        told = [t.model_copy(update={"payload": 0.0}) for t in told]
    rigs = [t.rig(plant, scenario) for t, scenario in zip(told, scenarios, strict=True)]
    for one, rig in zip(recordings, rigs, strict=True):
        if rig.hash != rigs[0].hash:
            came = f"another plant or other parameters than {recordings[0].name}"
            raise InvalidInputError(one.name, came, "one rig in all recordings of a diagnosis")
    ready = tuple(
        _windowed(_driven(one.recording, t, scenario), t, one.name)
        for one, t, scenario in zip(recordings, told, scenarios, strict=True)
    )
    if own:
        ready = tuple(map(with_load, ready, loads))
    return ready, rigs[0], scenarios[0]


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
