"""BlindVes2: measured rigs of VES II: half the step, another integrator, redrawn, shaken, noisy."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from typing import final

import mujoco
import numpy as np
from scipy.signal import lfilter

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.recording import Recording
from ves_twin.core.signals import SIGNALS, Role
from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.forward import Excitation
from ves_twin.machines.ves2.forward import RigForward
from ves_twin.machines.ves2.library import with_departures
from ves_twin.plant.plant import Plant
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.recorder import MemorySink
from ves_twin.simulator.simulate import recording_info
from ves_twin.simulator.simulator import Simulator
from ves_twin.suites.machine import BlindMachine, BlindRig

SECONDS = 10.0
"""Length of a record [s]."""

STILL_SECONDS = 40.0
"""Length of the standstill record [s]."""

SHAKEN = 0.5
"""Sd of a force on the platform that no model has [N], low-passed at about 1 Hz: people, hoses."""

LEVELS = (0.9, 1.12)
"""Noise of a rig against the table's."""

NOISES = ("transducer.noise", "sensor.noise", "arm.torque_noise", "supply.noise")

OUTSIDE = {
    "sensor_offset_step": (1.0, 15.0),
    "sensor_line": (0.5, 8.0),
    "sensor_square": (0.01, 0.2),
    "sensor_hysteresis": (0.5, 8.0),
    "stale_lengths": (1.0, 4.0),
    "gear_ripple": (0.3, 5.0),
    "arm_stop": (20.0, 400.0),
    "platform_drag": (200.0, 5000.0),
    "clock_skew": (2e-4, 3e-3),
}
"""Kinds that the library lacks: a step of the sensor's Fz [N], a line of 11.3 Hz on it [N], its
square law at full scale [1], its hysteresis [N]; one transducer some cycles late; ripple of the q2
gear [N m]; a soft stop within the range of q2 [N m/rad]; square-law drag on the platform
[N s^2/m^2]; the arm's clock running fast [1]."""


@final
class BlindVes2(BlindMachine):
    """VES II, measured.

    Args:
        plant: name of the nominal plant.
    """

    def __init__(self, plant: str) -> None:
        self.plant = Plant.load(plant)

    @cached_property
    def forward(self) -> RigForward:
        """As the diagnosis has it."""
        return RigForward(self.plant, self._programme("train"))

    @property
    def outside(self) -> Mapping[str, tuple[float, float]]:
        """Edits of what was recorded, of the compiled model, and forces of its own."""
        return OUTSIDE

    @property
    def confusable(self) -> tuple[str, ...]:
        """Lengths and anchor heights: a leg sees the difference only where it leans."""
        legs = range(1, 7)
        return (
            *(f"length_offset@leg.{k}" for k in legs),
            *(f"anchor_position@leg.{k}.z" for k in legs),
        )

    def record(
        self, rig: BlindRig, programme: str, rng: np.random.Generator, lead: float = 0.0
    ) -> Recording:
        """Legs and arm together (train), smaller on other lines, or a standstill.

        Raises:
            InvalidInputError: another programme, a lead, or a background: not built for this rig.
        """
        if programme not in ("train", "held_out", "standstill") or lead > 0.0 or rig.background:
            came = f"{programme}, lead {lead:g} s, background {dict(rig.background)}"
            expected = "train, held_out or standstill from rest, without a background"
            raise InvalidInputError("recording of VES II", came, expected)
        plant, offsets = with_departures(self.plant, rig.values)  # the noise wanders by itself
        plant = plant.with_values(
            {name: self.plant.parameters.array(name) * rng.uniform(*LEVELS) for name in NOISES}
        )
        sim = Simulator(
            plant,
            self._programme(programme, {"run.substeps": 2, **rig.deployed}),
            int(rng.integers(2**31)),
            MemorySink(),
        )
        sim.model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICIT
        _edit(sim, rig)
        _run(sim, rig, rng)
        rows = _collected(sim, self._programme(programme, {"run.substeps": 2}))
        rows.signals["sensor.wrench"][:] += offsets
        return _edited(rows, rig, rng, self.plant)

    def play(self, rig: BlindRig, programme: Excitation, rng: np.random.Generator) -> Recording:
        """Not built for this rig; raises InvalidInputError."""
        raise InvalidInputError("a next experiment", "VES II", "an MJCF machine")

    def _programme(self, name: str, more: Mapping[str, object] | None = None) -> Scenario:
        changes: dict[str, object] = {"plant": self.plant.name, "run.duration": SECONDS}
        if name == "held_out":
            changes |= {
                "platform.motion.period": 12.5,
                "platform.motion.amplitude": [0.04, 0.04, 0.04, 0.05, 0.05, 0.08],
            }
        if name == "standstill":
            changes |= {
                "run.duration": STILL_SECONDS,
                "platform.motion.amplitude": [0.0] * 6,
                "arm.moves": [],
            }
        return Scenario.load("identify_fast", changes | dict(more or {}))


def _edit(sim: Simulator, rig: BlindRig) -> None:
    if rig.outside == "arm_stop":
        joint = sim.model.joint("arm/q2").id
        sim.model.jnt_limited[joint] = 1
        sim.model.jnt_range[joint] = (np.deg2rad(35.0), np.deg2rad(170.0))
        sim.model.jnt_solref[joint] = (-rig.size, -0.1 * rig.size)


def _run(sim: Simulator, rig: BlindRig, rng: np.random.Generator) -> None:
    """Cycle by cycle, a force on the platform held over each."""
    period = sim.rig.clock.admittance * sim.rig.clock.tick
    count = int(np.ceil(sim.scenario.run.duration / period)) + 1
    slow = np.exp(-2.0 * np.pi * 1.0 * period)
    kick = SHAKEN * np.sqrt(1.0 - slow**2)
    pushes = lfilter([kick], [1.0, -slow], rng.standard_normal((count, 3)), axis=0)
    body = sim.model.body("platform/top").id
    for k in range(count):
        if sim.done:
            break
        force = pushes[k]
        if rig.outside == "platform_drag":
            velocity = sim.data.qvel[sim.rig.layout.platform_dof :][:3]
            force = force - rig.size * np.linalg.norm(velocity) * velocity
        sim.data.xfrc_applied[body, :3] = force
        sim.advance(period)


def _collected(sim: Simulator, written: Scenario) -> Recording:
    """What was measured, with the scenario as it is written, whatever is deployed."""
    time, signals = sim.recorder.collect()
    measured = {
        name: np.array(values)
        for name, values in signals.items()
        if SIGNALS[name].role not in {Role.TRUTH, Role.REFERENCE}
    }
    settings = written.model_dump_json()
    info = replace(recording_info(sim), scenario=written.name, settings=settings)
    return Recording(time, measured, info)


def _edited(
    recording: Recording, rig: BlindRig, rng: np.random.Generator, plant: Plant
) -> Recording:
    """What edits of the record make of it."""
    time, wrench = recording.time, recording.signals["sensor.wrench"]
    fz, size = wrench[:, 2], rig.size
    match rig.outside:
        case "sensor_offset_step":
            fz += size * (time > time[-1] * rng.uniform(0.3, 0.7))
        case "sensor_line":
            fz += size * np.sin(2.0 * np.pi * 11.3 * time)
        case "sensor_square":
            fz += size * fz**2 / float(plant.parameters.array("sensor.range")[2])
        case "sensor_hysteresis":
            fz += size * np.sign(np.gradient(lfilter([0.2], [1.0, -0.8], fz)))
        case "stale_lengths":
            lengths, late = recording.signals["leg.length"], round(size)
            lengths[late:, 3] = lengths[:-late, 3].copy()
        case "gear_ripple":
            recording.signals["arm.torque"][:, 1] += size * np.sin(
                60.0 * recording.signals["arm.q"][:, 1]
            )
        case "clock_skew":
            for name in ("arm.q", "arm.torque"):
                recording.signals[name][:] = _skewed(recording.signals[name], time, size)
    return recording


def _skewed(values: FloatArray, time: FloatArray, skew: float) -> FloatArray:
    columns = [np.interp(time * (1.0 + skew), time, column) for column in values.T]
    return np.stack(columns, axis=1)
