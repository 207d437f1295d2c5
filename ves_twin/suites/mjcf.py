"""BlindMjcf: measured machines of two files: half the step, another integrator, other noise."""

from __future__ import annotations

import copy
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import final

import mujoco
import numpy as np
from scipy.interpolate import CubicSpline
from scipy.signal import lfilter

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.core.types import FloatArray
from ves_twin.core.units import to_si
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.effects.effect import Effect
from ves_twin.effects.element import Element
from ves_twin.effects.joints import Backlash
from ves_twin.effects.place import Place
from ves_twin.machines.mjcf.inputs.programmes import Multisine, driven, joint_of, multisine
from ves_twin.machines.mjcf.mjcf_machine import MjcfMachine
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.motion.started import start_of, start_signal
from ves_twin.machines.mjcf.recordings.signals import rig_signals
from ves_twin.machines.mjcf.rig.description import Mode
from ves_twin.machines.mjcf.rig.machine import Rig
from ves_twin.suites.hidden_law import Acts, HiddenCommand, HiddenEffort
from ves_twin.suites.machine import BlindMachine, BlindRig

COUNT = 0.2
"""Step of a position's encoder, in sd of its noise."""

DISTURBANCE = 2e-4
"""Sd of an effort that no model has, low-passed, as a share of the typical one."""

SLOW = 0.95
"""Lag-one coefficient of the disturbance: about 4 Hz at rows of 2 ms."""

LEVELS, COLOURS = (0.9, 1.12), (0.0, 0.15)
"""Noise of a machine against what is declared, and its lag-one coefficient."""

PROGRAMMES = {"train": 1, "held_out": 2, "poor": 3, "standstill": 1}
"""Programme -> number of its draw."""

POOR = Multisine("poor", 0.06, (1.0, 0.12))
"""A recording that tells little: next to no inertia, so that mass, gain and spring look alike."""

INTEGRATORS = (mujoco.mjtIntegrator.mjINT_RK4, mujoco.mjtIntegrator.mjINT_IMPLICIT)
"""Of measured machines: the second where the first fails, as it may on stiff ones."""

OUTSIDE = {
    "quadratic_drag": (0.005, 0.05),
    "gravity_tilt": (0.01, 0.1),
    "late_drift": (0.01, 0.1),
    "offset_step": (0.005, 0.05),
    "line": (0.003, 0.02),
    "encoder_hysteresis": (0.003, 0.02),
    "soft_stop": (1.0, 10.0),
    "stuck_samples": (3.0, 12.0),
}
"""Kinds that the library lacks, in typical sizes of the first driven joint: drag [effort/speed^2],
gravity off the vertical [rad], drift that grows with the square of time [travel], a step of the
encoder [travel], a line of 9 Hz on it [travel], its backlash [travel], a stop within the range
[effort/travel], and samples that repeat [rows]. On a pendulum whose typical sizes are 1 they are
N m s^2/rad^2, rad and N m/rad."""

EDITS = ("quadratic_drag", "gravity_tilt", "soft_stop")
"""Those that change the model, the others what is read."""


STOPS = (-0.12, 3.0)
"""Range that a soft stop leaves, in typical travels: one end lies within the motion."""

CLAMPED = 64
"""Rows of which the first is what a clamped machine reads."""

DELAYS = ("actuator_delay", "sensor_delay")
"""From rest, in open loop, no recording tells one from the other."""


@dataclass(frozen=True)
class _Measured(Rig):
    """The two files with another model: as the laboratory has it."""

    compiled: mujoco.MjModel = field(kw_only=True, compare=False)
    hidden: tuple[tuple[Effect, Place], ...] = field(default=(), kw_only=True, compare=False)

    @cached_property
    def model(self) -> mujoco.MjModel:
        """As compiled."""
        return self.compiled

    def effects_at(self, values: Mapping[str, float]) -> Iterator[tuple[Effect, Place]]:
        """With what is hidden."""
        yield from super().effects_at(values)
        yield from self.hidden


@final
class BlindMjcf(BlindMachine):
    """Any machine of two files, measured.

    Args:
        rig: the two files.
    """

    def __init__(self, rig: Rig) -> None:
        self.rig = rig
        self.mode = rig.description.drive.mode
        if rig.description.clock.poses:
            raise InvalidInputError(f"blind suite of {rig.description.name}", "poses", "a motion")

    @cached_property
    def forward(self) -> MjcfForward:
        """As the diagnosis has it."""
        forward = MjcfForward.of(self.rig)
        forward.check_noise({channel.signal for channel in forward.channels})
        return forward

    @cached_property
    def outside(self) -> Mapping[str, tuple[float, float]]:
        """Edits of what was read, and of the model where motion is not fed in."""
        fed = self.mode is Mode.MOTION
        return {kind: size for kind, size in OUTSIDE.items() if not (fed and kind in EDITS)}

    @property
    def confusable(self) -> tuple[str, ...]:
        """Delays of command and sensors."""
        labels = [h.label for h in self.forward.hypotheses if h.effect in DELAYS]
        return tuple(labels) if len(labels) > 1 and self.mode is Mode.CONTROL else ()

    @property
    def errs(self) -> bool:
        """Where motion is fed in: a law of it needs some."""
        return bool(self._moved)

    @property
    def rate(self) -> float:
        """As the file says."""
        return self.rig.description.rate

    @property
    def excitations(self) -> Mapping[str, Excitation]:
        """Candidates of a next experiment."""
        return {one.name: one for one in MjcfMachine(self.rig).excitations()}

    def record(
        self, rig: BlindRig, programme: str, rng: np.random.Generator, lead: float = 0.0
    ) -> Recording:
        """A multisine in the band of the file, a faint slow one, or no command, clamped.

        Raises:
            InvalidInputError: no such programme, or a lead where a start cannot be read off.
        """
        if programme not in PROGRAMMES:
            raise InvalidInputError("programme", programme, f"one of {', '.join(PROGRAMMES)}")
        starts = self.rig.description.start.values()
        if lead and not any(start.elsewhere for start in starts):
            raise InvalidInputError(
                "cut", "no [start.JOINT.elsewhere]", "one in the machine's file"
            )
        if programme == "standstill":
            return self._standing(rig, self.programme(programme), rng)
        fed = self.programme(programme, lead)
        whole = self.play(rig, fed, rng)
        first = round(lead / fed.period)
        signals = {name: values[first:] for name, values in whole.signals.items()}
        return replace(whole, time=whole.time[: len(whole.time) - first], signals=signals)

    def programme(self, name: str, lead: float = 0.0) -> Excitation:
        """What is fed in, of `PROGRAMMES`; of a standstill, in which all of it is none, its rows.

        Args:
            name: which one.
            lead: by how much it is longer [s].
        """
        duration = self.rig.description.excitation.duration
        draw = np.random.default_rng(PROGRAMMES[name])
        if name == "standstill":
            return multisine(self.rig, draw, 4.0 * duration)
        if name != "poor":
            return multisine(self.rig, draw, duration + lead)
        fed = multisine(self.rig, draw, duration + lead, POOR)
        window = np.sin(np.linspace(0.0, np.pi, len(fed.time)))[:, None] ** 2
        return replace(fed, drive={signal: window * rows for signal, rows in fed.drive.items()})

    def _standing(self, rig: BlindRig, fed: Excitation, rng: np.random.Generator) -> Recording:
        """Clamped where it starts: one reading, and noise."""
        of_day = {p.name: p.nominal for p in self.forward.parameters if p.per_recording}
        still = {name: np.zeros_like(rows) for name, rows in fed.drive.items()}
        some = {name: rows[:CLAMPED] for name, rows in still.items()}
        values = {**rig.values, **of_day}
        first = self.forward.simulate(replace(fed, time=fed.time[:CLAMPED], drive=some), values)[0]
        fed = replace(fed, drive=still)
        return self._recorded(fed, np.tile(first, (len(fed.time), 1)), rig, rng)

    def play(self, rig: BlindRig, programme: Excitation, rng: np.random.Generator) -> Recording:
        """Commands from a given start.

        Rows are twice as dense where commands are held from row to row, so that delays are finer,
        and where columns have errors of their own: speeds are then those that motion has there. The
        last rows, beyond which a spline knows nothing, differ from the model's by that.
        """
        dense = 2 if self.mode is Mode.CONTROL or rig.errors else 1
        time = np.asarray(programme.period / dense * np.arange(dense * len(programme.time)), float)
        held = np.arange(len(time)) // dense
        drive = {name: rows[held] for name, rows in programme.drive.items()}
        for signal in self._moved:
            drive[signal] = CubicSpline(programme.time, programme.drive[signal])(time)
        if self.mode is Mode.CONTROL:
            kicks = lfilter([1.0 - SLOW], [1.0, -SLOW], rng.standard_normal(len(programme.time)))
            shaken = np.repeat(DISTURBANCE * kicks / np.sqrt((1.0 - SLOW) / (1.0 + SLOW)), dense)
            pushed = [(name, size) for name, _, size in driven(self.rig) if name not in self._moved]
            for signal, size in pushed:
                drive[signal] = drive[signal] + size * shaken[:, None]
        denser = replace(programme, time=time, drive=drive)
        rows = np.full((len(time), len(self.forward.channels)), np.nan)
        for integrator in INTEGRATORS:
            real = MjcfForward(self._real(rig, integrator), self.mode)
            rows = real.simulate(denser, rig.values)
            if np.all(np.isfinite(rows)):
                return self._recorded(programme, rows[::dense], rig, rng)
        came = f"{self.rig.description.name} at half the step fails under {programme.name}"
        raise InvalidInputError("recording", came, "a smaller excitation.amplitude")

    def _real(self, rig: BlindRig, integrator: mujoco.mjtIntegrator) -> Rig:
        model = copy.copy(self.rig.model)
        model.opt.timestep /= 2.0
        model.opt.integrator = integrator
        _, at, _ = driven(self.rig)[0]
        joint = model.joint(at.name)
        model.dof_dampingpoly[joint.dofadr[0], 0] += (
            rig.odd("quadratic_drag") * at.effort / at.speed**2
        )
        tilt, stop = rig.odd("gravity_tilt"), rig.odd("soft_stop") * at.effort / at.travel
        if tilt:
            x, y, z = model.opt.gravity
            cos, sin = np.cos(tilt), np.sin(tilt)
            model.opt.gravity[:] = x * cos - z * sin, y, x * sin + z * cos
        if stop:
            model.jnt_limited[joint.id] = 1
            model.jnt_range[joint.id] = STOPS[0] * at.travel, STOPS[1] * at.travel
            model.jnt_solref[joint.id] = (-40.0 * stop, -stop)
        told = self.rig
        return _Measured(
            told.description,
            told.folder,
            told.file,
            told.payloads,
            compiled=model,
            hidden=self._hidden(rig),
        )

    def _hidden(self, rig: BlindRig) -> tuple[tuple[Effect, Place], ...]:
        """A law that no library has, at a joint or its actuator; one of a column comes later."""
        law = rig.law
        if law is None or law.acts is Acts.READING:
            return ()
        if law.acts is not Acts.COMMAND:
            return ((HiddenEffort(law.place, law), joint_of(self.rig, law.place)),)
        name = law.of.partition("@")[2]
        return ((HiddenCommand(name, law), Place(Element.ACTUATOR, name)),)

    def _recorded(
        self, fed: Excitation, rows: FloatArray, rig: BlindRig, rng: np.random.Generator
    ) -> Recording:
        """What is outside the library, noise of another level and colour, counts."""
        clean, rows, channels = rows, rows.copy(), self.forward.channels
        for error in rig.errors:
            motion = self._motion(error.column, fed, clean)
            rows[:, error.column] += error.rows(motion, fed.period, rng)
        odd, span = self._place()
        rows[:, odd] = _misread(rows[:, odd], fed.time, span, rig, rng)
        if rig.law is not None and rig.law.acts is Acts.READING:
            at = [channel.name for channel in channels].index(rig.law.place)
            rows[:, at] += rig.law.function(rows[:, at])
        white = rng.uniform(*LEVELS) * rng.standard_normal(rows.shape) * [c.sd for c in channels]
        rows += lfilter([1.0], [1.0, -rng.uniform(*COLOURS)], white, axis=0)
        signals = dict(fed.drive)
        compared = self.rig.description.compare
        for i, channel in enumerate(channels):
            width = len(self.rig.description.signals[channel.signal].columns)
            values = signals.setdefault(channel.signal, np.zeros((len(rows), width)))
            if compared[channel.signal].joint and compared[channel.signal].of == "position":
                count = COUNT * channel.sd
                rows[:, i] = count * np.round(rows[:, i] / count)
            values[:, channel.column] = rows[:, i]
        own = tuple(s for s in rig_signals(self.rig) if s.name in signals)
        for joint in self.rig.description.start:
            own += (start_of(self.rig, joint),) if start_signal(joint) in signals else ()
        info = RecordingInfo(
            "measured", scenario=self.rig.description.name, period=fed.period, own_signals=own
        )
        return Recording(fed.time, signals, info)

    def _place(self) -> tuple[int, float]:
        """Channel that is misread, a driven joint's position if there is one; its typical size."""
        told = self.rig.description
        for i, channel in enumerate(self.forward.channels):
            compared = told.compare[channel.signal]
            if compared.joint and compared.of == "position":
                return i, joint_of(self.rig, compared.joint).travel
        return 0, self._span(0)

    def _span(self, number: int) -> float:
        """Typical size of a channel."""
        channel = self.forward.channels[number]
        span = self.rig.description.typical.signal.get(channel.signal)
        return to_si(span.span, channel.unit, "typical.signal") if span else 100.0 * channel.sd

    @property
    def _moved(self) -> dict[str, str]:
        """Positions that are fed in, with the joint of each."""
        joints = self.forward.imposed
        if self.mode is Mode.MOTION:
            joints = dict(self.rig.description.drive.joints)
        return {signal: joint for joint, signal in joints.items()}

    def _motion(self, number: int, fed: Excitation, rows: FloatArray) -> FloatArray:
        """What a law of the motion at a channel depends on, in typical sizes (n, 4).

        Position and speed of its joint, its own load, and the position of the next joint.
        """
        signals = list(self._moved)
        own = self.forward.leaders.get(self.forward.channels[number].signal, signals[0])
        other = signals[(signals.index(own) + 1) % len(signals)]
        at, beside = (joint_of(self.rig, self._moved[name]) for name in (own, other))
        position = fed.drive[own][:, 0]
        parts = (
            position / at.travel,
            np.gradient(position, fed.period) / at.speed,
            rows[:, number] / self._span(number),
            fed.drive[other][:, 0] / beside.travel,
        )
        return 2.0 * np.stack(parts, axis=1)


def _misread(
    column: FloatArray, time: FloatArray, span: float, rig: BlindRig, rng: np.random.Generator
) -> FloatArray:
    """A column (n,) with what no library has between the joint and its recording."""
    n = len(column)
    column = column + span * rig.odd("late_drift") * (time / time[-1]) ** 2
    if rig.odd("offset_step"):
        late = time > time[-1] * rng.uniform(0.3, 0.7)
        column = column + span * rig.odd("offset_step") * late
    column = column + span * rig.odd("line") * np.sin(2.0 * np.pi * 9.0 * time)
    column = Backlash("", gap=span * rig.odd("encoder_hysteresis")).edit_position(column)
    held = max(1, round(rig.odd("stuck_samples")))
    return np.asarray(column[np.arange(n) // held * held])
