"""implausible: what a machine's file cannot be right about, by recordings and before any fit."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import combinations

import mujoco
import numpy as np
from scipy.optimize import nnls

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.recording import POSES, Recording
from ves_twin.core.types import FloatArray
from ves_twin.data.column_expression import quoted
from ves_twin.diagnosis.forward import Excitation
from ves_twin.diagnosis.likeness import FACTORS
from ves_twin.machines.mjcf.cyclic import is_cyclic, turned_by
from ves_twin.machines.mjcf.forward import MjcfForward
from ves_twin.machines.mjcf.inverse import efforts_along, smoothed
from ves_twin.machines.mjcf.machine import Rig
from ves_twin.machines.mjcf.places import SINGLE, driven_joint
from ves_twin.machines.mjcf.predecessor import predecessor
from ves_twin.machines.mjcf.work import Work

ROWS = 10_000
"""Rows of a recording that are looked at, about its middle."""

FEWEST = 20
"""Rows below which nothing is said."""

BAD = 0.5
"""Share of an effort's spread that the model, and friction that resists, may leave: a published
arm without its frictions leaves 0.2 (TX40), a wrong sign two."""

GOOD = 0.35
"""Share from which another reading of the columns is right: by chance none comes as near."""

FEWER = 0.5
"""Times the share before, that another reading must leave at most."""

LOUD, MUCH = 0.2, 0.25
"""Share of an effort's spread from which, and times that share down to which, another reading is
right as well: an angle from the world spoils an effort less than a sign. Chosen on an arm of three
joints (a test), whose elbow read so leaves 0.48, and 0.07 read right."""

GROWS = 1.1
"""Times the share before, that it may leave of any other effort."""

ALIKE = 1.1
"""Times the least share, within which two readings are told together: a torque or the angle of its
joint turned is often the same."""

TURNS = {"a quarter turn": 0.5 * np.pi, "minus a quarter turn": -0.5 * np.pi, "half a turn": np.pi}
"""Between the zeros that laboratories have: hanging, upright, level."""

QUIET = 1e-3
"""Speed, as a share of the fastest, over which a sign is smoothed."""


@dataclass(frozen=True)
class Implausible:
    """What the columns of a machine look like instead.

    Attributes:
        what: the signals in question.
        came: what the recording shows.
        expected: which key of the machine's file to look at.
    """

    what: str
    came: str
    expected: str

    @property
    def error(self) -> InvalidInputError:
        """As a refusal."""
        return InvalidInputError(self.what, self.came, self.expected)


@dataclass(frozen=True)
class _Reading:
    """Columns read in another way: factors and order of positions and efforts, gravity's sign.

    `less` has positions of which another one, times 1 or -1, is taken off, `zeros` what is added.
    """

    name: str
    key: str
    positions: Mapping[str, float]
    efforts: Mapping[str, float]
    swapped: tuple[str, str] | None = None
    gravity: float = 1.0
    less: Mapping[str, tuple[str, float]] = field(default_factory=dict)
    zeros: Mapping[str, float] = field(default_factory=dict)


def implausible(rig: Rig, recording: Recording) -> Implausible | None:
    """What of a recording fits the machine only if it is read in another way.

    Where the position of every joint and the effort of an actuator were recorded, the effort must
    be that of inverse dynamics, an offset, and friction that takes energy out:

        u = u_rigid(q) + c v + f sign(v) + o,  c >= 0, f >= 0.

    That holds in every mode, since it is no simulation in time. Where it leaves most of an effort,
    signs, units and order of columns and the sign of gravity are turned round one by one; a
    reading that leaves a small part of it is named. Causes change an effort by a part of it. What
    leaves less, down to LOUD, may be an angle from the world alone.

    Args:
        rig: the machine.
        recording: of it.

    Returns:
        None where nothing can be said, or all is well.
    """
    seen = _Seen.of(rig, recording)
    if seen is None:
        return None
    plain = seen.left(_Reading("", "", {}, {}))
    if np.all(plain <= LOUD):
        return None
    found = []
    for reading in seen.readings() if np.any(plain > BAD) else seen.from_the_world():
        left = seen.left(reading)
        changed = (plain > BAD) & (left < np.minimum(FEWER * plain, GOOD))
        changed |= bool(reading.less) & (plain > LOUD) & (left < MUCH * plain)
        if np.any(changed) and np.all(left <= GROWS * np.maximum(plain, GOOD)):
            found.append((float(np.sum(np.minimum(left, 1.0))), changed, reading))
    if not found:
        return None
    least = min(score for score, _, _ in found)
    best = [(changed, reading) for score, changed, reading in found if score <= ALIKE * least]
    names = [seen.names[i] for i in np.flatnonzero(best[0][0])]
    came = " or ".join(dict.fromkeys(reading.name for _, reading in best))
    keys = " or ".join(dict.fromkeys(reading.key for _, reading in best))
    what = f"{', '.join(names)} of {recording.info.scenario or 'the recording'}"
    return Implausible(what, f"efforts that fit the model only with {came}", f"check {keys}")


def _wheels(rig: Rig, recording: Recording, joints: Sequence[str]) -> dict[str, FloatArray]:
    """Angles (n,) of those joints whose speed alone is told, where it is enough."""
    told = rig.description.compare
    speeds = {c.joint: (s, c.sign) for s, c in told.items() if c.joint and c.of == "speed"}
    speeds = {j: one for j, one in speeds.items() if one[0] in recording.signals}
    return {
        joint: turned_by(sign * recording[signal][:, 0], recording.time)
        for joint, (signal, sign) in speeds.items()
        if joint in joints and is_cyclic(rig.model, joint)
    }


@dataclass(frozen=True)
class _Seen:
    """Recorded positions and efforts.

    Attributes:
        rig: the machine.
        fed: the rows.
        positions: of every joint that is not locked (n,).
        efforts: of each actuator (n,), as the model signs them.
        names: signal of each effort.
        wheels: angles of joints whose speed alone was recorded, from where they began (n,).
    """

    rig: Rig
    fed: Excitation
    positions: Mapping[str, FloatArray]
    efforts: Mapping[str, FloatArray]
    names: tuple[str, ...]
    wheels: Mapping[str, FloatArray]

    @staticmethod
    def of(rig: Rig, recording: Recording) -> _Seen | None:
        """None where a joint's position or every effort is missing."""
        told, model, forward = rig.description, rig.model, MjcfForward.of(rig)
        joints = [model.joint(i).name for i in range(model.njnt)]
        places = {j: forward.position_of(j) for j in joints if j not in told.drive.locked}
        single = all(int(model.jnt_type[model.joint(j).id]) in SINGLE for j in joints)
        wheels = _wheels(
            rig, recording, [j for j, s in places.items() if s not in recording.signals]
        )
        places = {j: signal for j, signal in places.items() if j not in wheels}
        if not (single and places and all(s in recording.signals for s in places.values())):
            return None
        sources = {c.actuator: (s, c.sign) for s, c in told.compare.items() if c.actuator}
        sources |= {a: (s, 1) for a, s in told.drive.actuators.items()}
        sources = {
            a: (s, sign)
            for a, (s, sign) in sources.items()
            if s in recording.signals and driven_joint(model, a) in {*places, *wheels}
        }
        if not sources:
            return None
        count = len(recording.time)
        first = max(0, (count - ROWS) // 2)
        rows = slice(first, first + ROWS)
        signs = {c.joint: c.sign for c in told.compare.values() if c.of == "position" and c.joint}
        positions = {j: signs.get(j, 1) * recording[s][rows, 0] for j, s in places.items()}
        efforts = {a: sign * recording[s][rows, 0] for a, (s, sign) in sources.items()}
        wheels = {j: turned[rows] for j, turned in wheels.items()}
        every = [*positions.values(), *wheels.values(), *efforts.values()]
        if not all(np.all(np.isfinite(column)) for column in every):
            return None
        poses = recording.info.log == POSES
        if len(recording.time) < FEWEST:
            return None
        fed = Excitation("seen", recording.time[rows], {}, poses, told.rate)
        names = tuple(signal for signal, _ in sources.values())
        return _Seen(rig, fed, positions, efforts, names, wheels)

    @cached_property
    def _plain(self) -> Work:
        """Without friction of the joints: how much of it there is, is for the recording to say."""
        work = Work.begin(self.rig, self.fed, {})
        work.model.dof_damping[:] = 0.0
        work.model.dof_frictionloss[:] = 0.0
        return work

    def readings(self) -> Iterator[_Reading]:
        """Every other way to read the columns, one change at a time."""
        forward = MjcfForward.of(self.rig)
        angles = {joint: forward.position_of(joint) for joint in self.positions}
        sources = dict(zip(self.efforts, self.names, strict=True))
        for actuator, signal in sources.items():
            key = f"the sign of {signal}: compare.SIGNAL.sign, or signals.NAME.scale"
            yield _Reading(f"the other sign of {signal}", key, {}, {actuator: -1.0})
        for joint, signal in angles.items():
            key = f"the axis of joint {joint} and the sign of {signal}"
            yield _Reading(f"the other sign of {signal}", key, {joint: -1.0}, {})
        for names in (sources, angles):
            for word, share, group in self._units(names):
                told = ", ".join(names[n] for n in group)
                numbers = dict.fromkeys(group, share)
                both = ({}, numbers) if names is sources else (numbers, {})
                yield _Reading(f"{told} in {word}", f"unit and scale of {told}", *both)
            for one, two in combinations(names, 2):
                told = f"{names[one]} and {names[two]}"
                yield _Reading(f"{told} swapped", f"the columns of {told}", {}, {}, (one, two))
        yield from self.from_the_world()
        yield from self._before_gears(angles)
        yield from self._from_another_zero(angles)
        if len(self.efforts) > 1:
            every = dict.fromkeys(self.efforts, -1.0)
            yield _Reading("the other sign of all efforts", "the sign of all efforts", {}, every)
        key = "option.gravity of the model, and how its base stands"
        yield _Reading("gravity the other way", key, {}, {}, gravity=-1.0)

    def from_the_world(self) -> Iterator[_Reading]:
        """Angles that have the motion of joints before them in them: one, or all."""
        forward = MjcfForward.of(self.rig)
        angles = {joint: forward.position_of(joint) for joint in self.positions}
        found = {j: predecessor(self.rig.model, j, angles) for j in angles}
        less = {joint: before for joint, before in found.items() if before}
        for group in [[joint] for joint in less] + ([list(less)] if len(less) > 1 else []):
            told = ", ".join(angles[joint] for joint in group)
            formulas = " and ".join(self._formula(j, *less[j]) for j in group)
            own = {joint: less[joint] for joint in group}
            key = f"signals.NAME.columns: a formula as {formulas}"
            yield _Reading(f"{told} measured from the world", key, {}, {}, less=own)

    def _formula(self, joint: str, before: str, along: float) -> str:
        """The difference of two joints' columns, as a machine's file may hold it."""
        told, forward = self.rig.description, MjcfForward.of(self.rig)
        names = [forward.position_of(one) for one in (joint, before)]
        signs = {c.joint: c.sign for c in told.compare.values() if c.of == "position" and c.joint}
        one, two = (quoted(told.signals[name].columns[0]) for name in names)
        turned = np.prod([told.signals[name].scale for name in names])
        turned *= signs.get(joint, 1) * signs.get(before, 1) * along
        return f"{one} {'-' if turned > 0.0 else '+'} {two}"

    def _before_gears(self, angles: Mapping[str, str]) -> Iterator[_Reading]:
        """Angles of motors, whose gear stands in the model."""
        for actuator in self.efforts:
            joint = driven_joint(self.rig.model, actuator)
            gear = abs(float(self.rig.model.actuator(actuator).gear[0]))
            if gear not in (0.0, 1.0):
                name = f"{angles[joint]} of the motor, before its gear of {gear:g}"
                yield _Reading(name, f"the scale of {angles[joint]}", {joint: 1.0 / gear}, {})

    def _from_another_zero(self, angles: Mapping[str, str]) -> Iterator[_Reading]:
        """Angles that are zero a quarter or half a turn away."""
        for joint, signal in angles.items():
            if self.rig.description.signals[signal].unit != "rad":
                continue
            for word, turn in TURNS.items():
                name = f"{word} added to {signal}"
                key = f"signals.NAME.offset of {signal}: where it is zero"
                yield _Reading(name, key, {}, {}, zeros={joint: turn})

    def _units(self, names: Mapping[str, str]) -> Iterator[tuple[str, float, list[str]]]:
        """Other units, their factors, and who may have them: one signal, or all of one unit."""
        signals = self.rig.description.signals
        units = {name: signals[signal].unit for name, signal in names.items()}
        for unit in dict.fromkeys(units.values()):
            group = [name for name in names if units[name] == unit]
            for word, factor in FACTORS.get(unit, {}).items():
                yield from ((word, 1.0 / factor, [name]) for name in group)
                if len(group) > 1:
                    yield word, 1.0 / factor, group

    def left(self, reading: _Reading) -> FloatArray:
        """Share of the spread of each effort that inverse dynamics and friction leave (c,)."""
        positions = dict(self.wheels)
        positions |= {j: reading.positions.get(j, 1.0) * q for j, q in self.positions.items()}
        efforts = {a: reading.efforts.get(a, 1.0) * u for a, u in self.efforts.items()}
        for joint, zero in reading.zeros.items():
            positions[joint] = positions[joint] + zero
        for joint, (before, along) in reading.less.items():
            positions[joint] = positions[joint] - along * self.positions[before]
        if reading.swapped:
            one, two = reading.swapped
            for group in (positions, efforts):
                if one in group:
                    group[one], group[two] = group[two], group[one]
        work = self._plain
        model = work.model
        q = np.tile(model.qpos0, (len(self.fed.time), 1))
        v, a = np.zeros((len(q), model.nv)), np.zeros((len(q), model.nv))
        corner = self.rig.description.drive.smoothing
        for joint, column in positions.items():
            at = model.joint(joint)
            smooth = column if self.fed.poses else smoothed(column, self.fed.period, corner)
            q[:, at.qposadr[0]] = smooth
            if not self.fed.poses:
                v[:, at.dofadr[0]] = np.gradient(smooth, self.fed.period)
                a[:, at.dofadr[0]] = np.gradient(v[:, at.dofadr[0]], self.fed.period)
        gravity = model.opt.gravity.copy()
        model.opt.gravity[:] = reading.gravity * gravity
        needs = efforts_along(work, list(efforts), q, v, a)
        model.opt.gravity[:] = gravity
        return np.array([self._share(model, n, efforts[n], needs[n], v, corner) for n in efforts])

    def _share(
        self,
        model: mujoco.MjModel,
        actuator: str,
        effort: FloatArray,
        need: FloatArray,
        speed: FloatArray,
        corner: float,
    ) -> float:
        """Of one effort: what friction that resists, and an offset, leave beside what it needs."""
        own = speed[:, int(model.joint(driven_joint(model, actuator)).dofadr[0])]
        gain = float(model.actuator(actuator).gear[0] * model.actuator(actuator).gainprm[0])
        quiet = QUIET * max(float(np.max(np.abs(own))), 1e-30)
        one = np.ones_like(own)
        basis = np.stack([own / gain, np.tanh(own / quiet) / gain, one, -one], axis=1)
        if not self.fed.poses:
            effort = smoothed(effort, self.fed.period, corner)
        scale = np.maximum(np.linalg.norm(basis, axis=0), 1e-30)
        _, rest = nnls(basis / scale, effort - need)
        spread = float(np.linalg.norm(effort - np.mean(effort)))
        return float(rest) / max(spread, 1e-30)


def check_plausible(rig: Rig, recordings: Sequence[Recording]) -> None:
    """Refuse the first recording that fits the machine only if it is read in another way.

    Raises:
        InvalidInputError: says which columns, and which key of the file to look at.
    """
    for recording in recordings:
        found = implausible(rig, recording)
        if found is not None:
            raise found.error
