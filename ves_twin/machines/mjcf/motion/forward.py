"""MjcfForward: an MJCF machine as the diagnosis sees it."""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.core.units import to_si
from ves_twin.diagnosis.model.directional import Moment, Visited
from ves_twin.diagnosis.model.forward import Channel, Excitation, Hypothesis, Parameter
from ves_twin.diagnosis.model.law_forward import LawPlace
from ves_twin.effects.law import Law, LawKind, variable_along
from ves_twin.machines.mjcf.motion.inverse import efforts_of_motion
from ves_twin.machines.mjcf.motion.missing import missing_efforts
from ves_twin.machines.mjcf.motion.one_way import one_way_twins
from ves_twin.machines.mjcf.motion.started import read_from, signal_of, start_signal
from ves_twin.machines.mjcf.motion.stepping import motion_of_drive
from ves_twin.machines.mjcf.motion.work import Work
from ves_twin.machines.mjcf.parts.joint_units import joint_units
from ves_twin.machines.mjcf.rig.description import Compared, Mode
from ves_twin.machines.mjcf.rig.law_places import law_places
from ves_twin.machines.mjcf.rig.machine import Rig
from ves_twin.machines.mjcf.rig.places import driven_joint

KEPT = 4
"""Motions that are kept while laws of readings are tried: they change none."""


@dataclass(frozen=True)
class MjcfForward:
    """Parameters in, recorded columns out.

    Attributes:
        rig: the two files.
        mode: what is fed in; that of the file unless another one is asked for.
    """

    rig: Rig
    mode: Mode

    @staticmethod
    def of(rig: Rig, mode: Mode | None = None) -> MjcfForward:
        """As the file says, or in another mode that the file has the signals for."""
        return MjcfForward(rig, mode or rig.description.drive.mode)

    @cached_property
    def identity(self) -> str:
        """Changes with files, mode, library and versions."""
        return f"{self.rig.identity}-{self.mode}"

    @property
    def fed(self) -> tuple[str, ...]:
        """Signals that are fed in."""
        told = self.rig.description
        if self.mode is Mode.MOTION:
            names = list(told.drive.joints.values())
        elif self.mode is Mode.CONTROL:
            names = list(told.drive.actuators.values())
        else:
            names = [c.reference for c in told.controllers.values()]
        return tuple(dict.fromkeys([*names, *self.imposed.values()]))

    @property
    def imposed(self) -> dict[str, str]:
        """Joints that move as recorded while others are integrated, with their signals."""
        return {} if self.mode is Mode.MOTION else self.rig.description.drive.imposed_signals

    @cached_property
    def drive(self) -> tuple[str, ...]:
        """Signals that are fed in, and those that the start is read from."""
        told = self.rig.description
        if self.mode is Mode.MOTION:
            return self.fed
        measured = [j for j, start in told.start.items() if start.position == "measured"]
        positions = [read_from(told, joint)[0] for joint in measured]
        recorded = [start_signal(j) for j, s in told.start.items() if s.position == "recorded"]
        return tuple(dict.fromkeys([*self.fed, *positions, *recorded]))

    def position_of(self, joint: str) -> str:
        """The signal that a joint's position is read from; empty if there is none."""
        return signal_of(self.rig.description, joint, "position")

    def joint_of(self, actuator: str) -> str:
        """The joint that an actuator drives; empty where it drives a tendon or a site."""
        return driven_joint(self.rig.model, actuator)

    @cached_property
    def leaders(self) -> dict[str, str]:
        """Compared signal -> the signal fed in for its own joint, where there is one."""
        told = self.rig.description
        of_joint = dict(told.drive.joints) if self.mode is Mode.MOTION else self.imposed
        if self.mode is Mode.REFERENCE:
            of_joint |= {c.joint: c.reference for c in told.controllers.values()}
        found = {}
        for name, one in self.compared.items():
            joint = one.joint
            if one.actuator:
                joint = self.joint_of(one.actuator)
            leader = of_joint.get(joint, "")
            if leader and len(told.signals[leader].columns) == 1:
                found[name] = leader
        return found

    @cached_property
    def compared(self) -> dict[str, Compared]:
        """Signals that this mode predicts."""
        told = self.rig.description.compare
        if self.mode is Mode.MOTION:
            return {n: c for n, c in told.items() if c.actuator or c.sensor}
        predicted = {n: c for n, c in told.items() if c.joint not in self.imposed}
        if self.mode is Mode.CONTROL:
            needs = self.imposed
            return {
                n: c
                for n, c in predicted.items()
                if not c.actuator or self.joint_of(c.actuator) in needs
            }
        return predicted

    @cached_property
    def channels(self) -> tuple[Channel, ...]:
        """Measured columns with the noise that the file declares."""
        found = []
        moving = () if self.mode is Mode.MOTION else self.rig.description.start.values()
        settling = max((start.settling for start in moving), default=0.0)
        if self.mode is Mode.CONTROL:
            settling += self.rig.description.drive.lead
        for name in self.compared:
            signal = self.rig.description.signals[name]
            noises = signal.noise if isinstance(signal.noise, tuple) else (signal.noise,)
            width = len(signal.columns)
            noises = noises * width if len(noises) == 1 else noises
            for i, noise in enumerate(noises[:width]):
                label = name if width == 1 else f"{name}.{i + 1}"
                sd = to_si(noise, signal.unit, f"noise of {name}")
                found.append(Channel(label, name, i, signal.unit, sd, settling=settling))
        return tuple(found)

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:
        """Sizes of effects, and the start of each recording."""
        return (*self.rig.parameters, *(() if self.mode is Mode.MOTION else self._starts()))

    @property
    def hypotheses(self) -> tuple[Hypothesis, ...]:
        """The library of causes that the file allows."""
        return self.rig.hypotheses

    def check_noise(self, recorded: Container[str]) -> None:
        """Raise InvalidInputError where a signal that is to be diagnosed has no noise.

        A comparison does without; a diagnosis weighs each row by it.
        """
        for channel in self.channels:
            if channel.signal in recorded and not channel.sd > 0.0:
                expected = f"noise = the sd of one row, above 0 {channel.unit}, of what is compared"
                came = "none" if channel.sd == 0.0 else channel.sd
                raise InvalidInputError(f"signals.{channel.signal}.noise", came, expected)

    def simulate(
        self,
        programme: Excitation,
        values: Mapping[str, float],
        refined: bool = False,
        laws: Sequence[Law] = (),
    ) -> FloatArray:
        """Channels (n, channels) that a rig with these values and laws records, without noise."""
        work = Work.begin(self.rig, programme, values, laws)
        signals, along = self._moved(work, refined)
        rows = np.concatenate([work.reading(n, signals[n]) for n in self.compared], axis=1)
        for law in work.laws:
            if law.kind is LawKind.READING:
                at = self._labels.index(law.place)
                rows[:, at] = law.read(
                    rows[:, at], *(variable_along(name, along) for name in law.of)
                )
        return rows

    def visited(
        self, programme: Excitation, values: Mapping[str, float], laws: Sequence[Law] = ()
    ) -> Mapping[str, FloatArray]:
        """Variables that laws depend on (n,), as simulated."""
        return self._moved(Work.begin(self.rig, programme, values, laws), False)[1]

    def one_way_twins(
        self, labels: Sequence[str], moments: Sequence[Moment], visited: Visited | None = None
    ) -> Mapping[str, tuple[str, ...]]:
        """See `Directional`."""
        return one_way_twins(self.rig, labels, moments, visited or self.visited)

    def law_places(self) -> tuple[LawPlace, ...]:
        """Joints and compared columns at which a law may act."""
        return law_places(self.rig, self.channels, self.mode)

    @property
    def band(self) -> float:
        """Corner [Hz] of the low-pass before positions are differentiated."""
        return self.rig.description.drive.smoothing

    def effort_unit(self, joint: str) -> str:
        """N or N*m, as a joint slides or turns."""
        return "N*m" if joint_units(self.rig.model, joint)[0] == "rad" else "N"

    def missing(
        self,
        programme: Excitation,
        values: Mapping[str, float],
        measured: Mapping[str, FloatArray],
        as_nominal: bool = False,
        laws: Sequence[Law] = (),
    ) -> tuple[Mapping[str, FloatArray], Mapping[str, FloatArray]] | None:
        """Efforts by joint that a measured motion asks for beyond the model; see `LawForward`."""
        model, told = self.rig.model, self.rig.description
        positions = {
            one.joint: one.sign * measured[name]
            for name, one in self.compared.items()
            if one.joint and one.of == "position" and name in measured
        }
        single = {model.joint(n).name for n in range(model.njnt)}
        if self.mode is not Mode.CONTROL or self.imposed or not single <= positions.keys():
            return None
        driven = [self.joint_of(name) for name in told.drive.actuators]
        if not single.issuperset(driven) or len(set(driven)) != len(driven):
            return None
        return missing_efforts(Work.begin(self.rig, programme, values, laws), positions, as_nominal)

    def _moved(
        self, work: Work, refined: bool
    ) -> tuple[Mapping[str, FloatArray], Mapping[str, FloatArray]]:
        """Signals and variables."""
        if any(law.kind is LawKind.READING for law in work.laws):
            return _kept(_Asked(_key(work, self.mode, refined), work, self.mode, refined))
        return _moved(work, self.mode, refined)

    @cached_property
    def _labels(self) -> list[str]:
        return [channel.name for channel in self.channels]

    def _starts(self) -> tuple[Parameter, ...]:
        found = []
        for joint, start in self.rig.description.start.items():
            units = joint_units(self.rig.model, joint)
            sds = (start.sd, start.speed_sd)
            for what, unit, told in zip(("position", "speed"), units, sds, strict=True):
                sd = to_si(told, unit, f"start.{joint}")
                reach = 100.0 * sd or 1.0
                name = f"start@{joint}:{what}"
                found.append(Parameter(name, unit, 0.0, -reach, reach, sd, per_recording=True))
        return tuple(found)


Moved = tuple[Mapping[str, FloatArray], Mapping[str, FloatArray]]
"""Signals (n, w), and variables (n,)."""


def _moved(work: Work, mode: Mode, refined: bool) -> Moved:
    if mode is Mode.MOTION:
        return efforts_of_motion(work)
    motion = motion_of_drive(work, mode, refined)
    return motion.signals, motion.variables


@dataclass(frozen=True)
class _Asked:
    """A motion; equal to another one if its key is. Laws of readings do not change it."""

    key: tuple[object, ...]
    work: Work = field(compare=False)
    mode: Mode = field(compare=False)
    refined: bool = field(compare=False)


def _key(work: Work, mode: Mode, refined: bool) -> tuple[object, ...]:
    values = tuple(sorted(work.values.items()))
    laws = tuple(law for law in work.laws if law.kind is LawKind.EFFORT)
    return work.rig.identity, work.programme.identity, values, laws, mode, refined


@lru_cache(maxsize=KEPT)
def _kept(asked: _Asked) -> Moved:
    return _moved(asked.work, asked.mode, asked.refined)
