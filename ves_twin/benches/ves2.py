"""RigForward: VES II as the diagnosis sees it: set-points in, lengths, wrench and torques out."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ves_twin.benches.ves2_library import (
    hypotheses_of,
    offset_parameters,
    parameters_of,
    table_parameters,
    with_departures,
)
from ves_twin.diagnosis.forward import Channel, Hypothesis, Parameter, Programme
from ves_twin.plant.plant import Plant
from ves_twin.recording.recording import Recording, RecordingInfo
from ves_twin.scenario.schema import Scenario
from ves_twin.signals import SIGNALS
from ves_twin.simulator.replay import replay
from ves_twin.simulator.simulate import versions
from ves_twin.types import FloatArray

DRIVE = ("leg.command", "arm.command", "gravity.estimate")
COMPARED = ("leg.length", "sensor.wrench", "arm.q", "arm.torque", "supply.pressure")

REPEATABLE = 1e-5
"""What a leg length is good for [m]: joints and frame give that much, far above the transducer."""


@dataclass(frozen=True)
class RigForward:
    """VES II under position control, the loop cut above the legs.

    Attributes:
        plant: the nominal rig.
        scenario: rates, leg gains and where the arm starts.
        exclude: kinds of effects that are left out of the library.
    """

    plant: Plant
    scenario: Scenario
    exclude: frozenset[str] = frozenset()

    @cached_property
    def identity(self) -> str:
        """Changes with plant, settings, library and versions."""
        parts = (self.plant.hash, self.scenario.model_dump_json(), versions())
        digest = hashlib.sha256(repr(parts).encode())
        digest.update(repr((self.parameters, self.hypotheses, self.channels)).encode())
        return digest.hexdigest()[:16]

    @property
    def drive(self) -> tuple[str, ...]:
        """Set-points of legs and arm, and the estimate that the sensor is zeroed against."""
        return DRIVE

    @cached_property
    def channels(self) -> tuple[Channel, ...]:
        """Measured columns with the sd that the plant's own numbers declare."""
        sds = noise_of(self.plant)
        return tuple(
            Channel(column, name, i, unit, float(sds[name][i]))
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
        )

    @cached_property
    def hypotheses(self) -> tuple[Hypothesis, ...]:
        """Every effect on every target that it can have."""
        return hypotheses_of(self.plant, self.exclude)

    def simulate(
        self, programme: Programme, values: Mapping[str, float], refined: bool = False
    ) -> FloatArray:
        """Channels (n, channels) that a rig with these values measures, without noise."""
        plant, offsets = with_departures(self.plant, values)
        scenario = self.scenario
        if refined:
            run = scenario.run.model_copy(update={"substeps": 2 * scenario.run.substeps})
            scenario = scenario.model_copy(update={"run": run})
        start = programme.time[0]
        recording = Recording(programme.time - start, programme.drive, RecordingInfo("measured"))
        answer = replay(recording, plant, DRIVE, COMPARED, scenario)
        rows = np.concatenate([answer[name] for name in COMPARED], axis=1)
        wrench = slice(6, 12)
        rows[:, wrench] += offsets
        return np.asarray(rows)


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
