"""BlindVes2: measured rigs of VES II: half the step, another integrator, redrawn, shaken, noisy."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from typing import final

import mujoco
import numpy as np
from scipy.signal import lfilter
from scipy.spatial.transform import Rotation

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.recording import Recording
from ves_twin.core.signals import SIGNALS, Role
from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.machines.ves2.forward import RigForward
from ves_twin.machines.ves2.library import with_departures
from ves_twin.plant.plant import Plant
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.recorder import MemorySink
from ves_twin.simulator.simulate import recording_info
from ves_twin.simulator.simulator import Simulator
from ves_twin.suites.hidden_in_ves2 import hidden_effort, hidden_reading
from ves_twin.suites.hidden_law import Acts
from ves_twin.suites.machine import BlindMachine, BlindRig, Edit

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
    "gear_ripple": (0.3, 5.0),
    "arm_stop": (20.0, 400.0),
    "platform_drag": (200.0, 5000.0),
    "clock_skew": (2e-4, 3e-3),
    "clipped_channel": (0.3, 0.9),
    "encoder_slip": (2e-3, 3e-2),
}
"""Kinds that the library lacks: a step of the sensor's Fz [N], a line of 11.3 Hz on it [N], its
square law at full scale [1], its hysteresis [N]; ripple of the q2 gear [N m]; a soft stop within
the range of q2 [N m/rad]; square-law drag on the platform [N s^2/m^2]; the arm's clock running fast
[1]; Fz cut off at a share of its largest [1]; the encoder of q3 slipping half way [rad]."""

OFTEN = 37
"""Times in a cycle that a hidden law is asked: every tick of the rig, every second of its steps."""

LATE_CLOCK = "late_sensor_clock"

EDITS = {
    "payload_off_centre": Edit("mass_centre@arm.link3.y:shift", 0.01, 0.08),
    "leaning_gravity": Edit("base_tilt@rig:roll", 1e-3, 2e-2),
    "friction_loss": Edit("coulomb_friction@arm.q2:level", 2.0, 20.0),
    LATE_CLOCK: Edit("sensor_delay@sensor:delay", 2e-3, 1.5e-2),
    "crossed_wires": Edit("cross_talk@sensor.mx.fz:share", 5e-3, 5e-2),
    "logged_length": Edit("recorder_offset@leg.length.3:offset", 4e-4, 5e-3),
    "late_length": Edit("recorder_delay@leg.length.4:delay", 5e-3, 4e-2),
    "logged_angle": Edit("recorder_offset@arm.q.2:offset", 1e-3, 1e-2),
}
"""What makes causes of the library here, without a class of effect: edits of the compiled model
(centre of mass of the last link along its y, gravity, friction loss of q2) and of the recording."""


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
    def edits(self) -> Mapping[str, Edit]:
        """Of the compiled model, and of what was recorded."""
        return EDITS

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
        log = {"run.log": "tick"} if rig.outside == LATE_CLOCK else {}
        scenario = self._programme(programme, {"run.substeps": 2, **rig.deployed, **log})
        sim = _Edited(rig, plant, scenario, int(rng.integers(2**31)))
        sim.model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICIT
        _run(sim, rig, rng)
        rows = _collected(sim, self._programme(programme, {"run.substeps": 2}))
        if rig.law is not None and rig.law.acts is Acts.READING:
            signals = {name: np.array(values) for name, values in rows.signals.items()}
            hidden_reading(rig.law, signals, sim.recorder.collect()[1], rows.time)
            rows = replace(rows, signals=signals)
        if log:
            rows = _sampled_late(rows, sim.rig.clock.admittance, rig.size)
        signals = {name: np.array(values) for name, values in rows.signals.items()}
        signals["sensor.wrench"] += offsets
        _edit_signals(signals, rows.time, rig, rng, self.plant)
        return replace(rows, signals=signals)

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


class _Edited(Simulator):
    """With edits of the compiled model, in place before the rig settles."""

    def __init__(self, hidden: BlindRig, plant: Plant, scenario: Scenario, seed: int) -> None:
        self._hidden = hidden
        super().__init__(plant, scenario, seed, MemorySink())

    def _settle(self) -> None:
        _edit(self.model, self._hidden)
        super()._settle()


def _edit(model: mujoco.MjModel, rig: BlindRig) -> None:
    match rig.outside:
        case "arm_stop":
            joint = model.joint("arm/q2").id
            model.jnt_limited[joint] = 1
            model.jnt_range[joint] = (np.deg2rad(35.0), np.deg2rad(170.0))
            model.jnt_solref[joint] = (-rig.size, -0.1 * rig.size)
        case "payload_off_centre":
            model.body_ipos[model.body("arm/link3").id, 1] += rig.size
        case "leaning_gravity":
            turn = Rotation.from_rotvec([-rig.size, 0.0, 0.0])
            model.opt.gravity[:] = turn.apply(model.opt.gravity)
        case "friction_loss":
            model.dof_frictionloss[model.joint("arm/q2").dofadr[0]] += rig.size


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
        if rig.outside == "encoder_slip" and k == count // 2:
            sim.rig.parameters[0]["drive"]["encoder_offset"][2] += rig.size
        force = pushes[k]
        if rig.outside == "platform_drag":
            velocity = sim.data.qvel[sim.rig.layout.platform_dof :][:3]
            force = force - rig.size * np.linalg.norm(velocity) * velocity
        sim.data.xfrc_applied[body, :3] = force
        if rig.law is None or rig.law.acts is Acts.READING:
            sim.advance(period)
            continue
        for _ in range(OFTEN):
            sim.data.qfrc_applied[:] = hidden_effort(sim, rig.law)
            sim.advance(period / OFTEN)


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


def _sampled_late(rows: Recording, every: int, delay: float) -> Recording:
    """Every so many rows, with the wrench as it was a delay before each of them."""
    time = rows.time[::every]
    late = [np.interp(time - delay, rows.time, column) for column in rows["sensor.wrench"].T]
    signals = {name: values[::every] for name, values in rows.signals.items()}
    signals["sensor.wrench"] = np.stack(late, axis=1)
    info = replace(rows.info, period=every * rows.info.period)
    return Recording(time, signals, info)


def _edit_signals(
    signals: dict[str, FloatArray],
    time: FloatArray,
    rig: BlindRig,
    rng: np.random.Generator,
    plant: Plant,
) -> None:
    """What edits of the record make of it, in place."""
    size = rig.size
    _edit_wrench(signals["sensor.wrench"], time, rig, rng, plant)
    match rig.outside:
        case "logged_length":
            signals["leg.length"][:, 2] += size
        case "late_length":
            lengths = signals["leg.length"]
            lengths[:, 3:4] = _late(lengths[:, 3:4], time, size)
        case "logged_angle":
            signals["arm.q"][:, 1] += size
        case "gear_ripple":
            signals["arm.torque"][:, 1] += size * np.sin(60.0 * signals["arm.q"][:, 1])
        case "clock_skew":
            for name in ("arm.q", "arm.torque"):
                signals[name] = _skewed(signals[name], time, size)


def _edit_wrench(
    wrench: FloatArray, time: FloatArray, rig: BlindRig, rng: np.random.Generator, plant: Plant
) -> None:
    fz, size = wrench[:, 2], rig.size
    ranges = plant.parameters.array("sensor.range")
    match rig.outside:
        case "sensor_offset_step":
            fz += size * (time > time[-1] * rng.uniform(0.3, 0.7))
        case "sensor_line":
            fz += size * np.sin(2.0 * np.pi * 11.3 * time)
        case "sensor_square":
            fz += size * fz**2 / float(ranges[2])
        case "sensor_hysteresis":
            fz += size * np.sign(np.gradient(lfilter([0.2], [1.0, -0.8], fz)))
        case "clipped_channel":
            limit = size * np.max(np.abs(fz))
            np.clip(fz, -limit, limit, out=fz)
        case "crossed_wires":
            wrench[:, 3] += size * ranges[3] / ranges[2] * fz


def _late(values: FloatArray, time: FloatArray, delay: float) -> FloatArray:
    return np.stack([np.interp(time - delay, time, column) for column in values.T], axis=1)


def _skewed(values: FloatArray, time: FloatArray, skew: float) -> FloatArray:
    columns = [np.interp(time * (1.0 + skew), time, column) for column in values.T]
    return np.stack(columns, axis=1)
