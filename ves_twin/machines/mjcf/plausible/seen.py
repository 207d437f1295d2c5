"""Seen: recorded positions and efforts, and what inverse dynamics leaves of the efforts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.optimize import nnls

from ves_twin.core.recording.recording import POSES, Recording
from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.motion.inverse import efforts_along
from ves_twin.machines.mjcf.motion.smoothed import smoothed
from ves_twin.machines.mjcf.motion.work import Work
from ves_twin.machines.mjcf.parts.cyclic import is_cyclic, turned_by
from ves_twin.machines.mjcf.parts.inertials import inertials, point_mass, set_inertials
from ves_twin.machines.mjcf.parts.servo import is_servo
from ves_twin.machines.mjcf.plausible.reading import Reading
from ves_twin.machines.mjcf.plausible.readings import Readings
from ves_twin.machines.mjcf.rig.machine import Rig
from ves_twin.machines.mjcf.rig.places import SINGLE, driven_joint
from ves_twin.machines.mjcf.rig.tied import ties_of
from ves_twin.machines.mjcf.rig.transmission import told_by_motion

ROWS = 10_000
"""Rows of a recording that are looked at, about its middle."""


FEWEST = 20
"""Rows below which nothing is said."""


STRANGE = 20.0
"""Times what the model needs, from which an effort is in another unit: a load is a few times."""

BESIDE = 0.5
"""Share of an effort's spread that an inertia more may leave, and its unit is right."""

ROUNDING = 1e-12
"""Spread of an effort, as a share of its size, below which it never changes."""

QUIET = 1e-3
"""Speed, as a share of the fastest, over which a sign is smoothed."""


@dataclass(frozen=True)
class Seen:
    """Recorded positions and efforts.

    Attributes:
        rig: the machine.
        fed: the rows.
        positions: of every joint that is not locked (n,), low-passed without phase.
        efforts: of each actuator (n,), as the model signs them, low-passed as the positions.
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
    def of(rig: Rig, recording: Recording) -> Seen | None:
        """None where a joint's position or every effort is missing: servos alone tell none."""
        told, model, forward = rig.description, rig.model, MjcfForward.of(rig)
        joints = [model.joint(i).name for i in range(model.njnt)]
        still = {*told.drive.locked, *(one.joint for one in ties_of(told, model).followers)}
        places = {j: forward.position_of(j) for j in joints if j not in still}
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
            if s in recording.signals and driven_joint(model, a) in {*places, *wheels, *still}
            if not is_servo(model, model.actuator(a).id)  # a set-point is no effort
        }
        sources = {a: sources[a] for a in told_by_motion(model, sources)}
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
        if not poses:
            for group in (positions, wheels, efforts):
                for name, column in group.items():
                    group[name] = smoothed(column, fed.period, told.drive.smoothing)
        names = tuple(signal for signal, _ in sources.values())
        return Seen(rig, fed, positions, efforts, names, wheels)

    @property
    def readings(self) -> Readings:
        """Other ways to read them."""
        forward = MjcfForward.of(self.rig)
        angles = {joint: forward.position_of(joint) for joint in self.positions}
        return Readings(self.rig, dict(zip(self.efforts, self.names, strict=True)), angles)

    @cached_property
    def _plain(self) -> Work:
        """Without friction of the joints: how much of it there is, is for the recording to say."""
        work = Work.begin(self.rig, self.fed, {})
        work.model.dof_damping[:] = 0.0
        work.model.dof_frictionloss[:] = 0.0
        return work

    def in_another_unit(self) -> Iterator[Reading]:
        """Efforts by a factor that no usual unit has: counts, a gear that the model lacks."""
        path = self._path({**self.wheels, **self.positions}, ROWS)
        needs = self._needs(Reading("", "", {}, {}), list(self.efforts), path)
        times = {a: self._times(a, self.efforts[a], needs[a], path) for a in self.efforts}
        odd = {a: s for a, s in times.items() if s > STRANGE or 0.0 < s < 1.0 / STRANGE}
        if odd:
            names = dict(zip(self.efforts, self.names, strict=True))
            told = ", ".join(names[a] for a in odd)
            by = " and ".join(f"{1.0 / s:.3g}" for s in odd.values())
            key = f"unit and scale of {told}, and gears of the model"
            factors = {a: 1.0 / s for a, s in odd.items()}
            yield Reading(f"{told} times {by}", key, {}, factors, odd=True)

    def _times(
        self,
        actuator: str,
        effort: FloatArray,
        need: FloatArray,
        path: tuple[FloatArray, ...],
    ) -> float:
        """Times what the model needs that an effort is, beside friction.

        Once where an inertia at the joint, which models of geared drives lack, fits beside that.
        """
        dof = int(self.rig.model.joint(driven_joint(self.rig.model, actuator)).dofadr[0])
        own, effort = path[1][:, dof], effort[self._few(ROWS)]
        quiet = QUIET * max(float(np.max(np.abs(own))), 1e-30)
        friction = [own, np.tanh(own / quiet), np.ones_like(own)]
        beside = np.stack([path[2][:, dof], *friction], axis=1)
        rest = effort - need
        rest = rest - beside @ np.linalg.lstsq(beside, rest, rcond=None)[0]
        if np.std(rest) < BESIDE * np.std(effort):
            return 1.0
        basis = np.stack([need, *friction], axis=1)
        return float(np.linalg.lstsq(basis, effort, rcond=None)[0][0])

    def left(self, reading: Reading, rows: int = ROWS) -> FloatArray:
        """Share of the spread of each effort that inverse dynamics and friction leave (c,).

        Args:
            reading: of the columns.
            rows: that are looked at, at even steps.
        """
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
        path = self._path(positions, rows)
        needs = self._needs(reading, list(efforts), path)
        return np.array([self._share(n, efforts[n], needs[n], path[1], rows) for n in efforts])

    def _path(self, positions: Mapping[str, FloatArray], rows: int) -> tuple[FloatArray, ...]:
        """Qpos (n, nq), qvel and qacc (n, nv) at some rows."""
        model = self.rig.model
        q = np.tile(model.qpos0, (len(self.fed.time), 1))
        v, a = np.zeros((len(q), model.nv)), np.zeros((len(q), model.nv))
        for joint, column in positions.items():
            at = model.joint(joint)
            q[:, at.qposadr[0]] = column
            if not self.fed.poses:
                v[:, at.dofadr[0]] = np.gradient(column, self.fed.period)
                a[:, at.dofadr[0]] = np.gradient(v[:, at.dofadr[0]], self.fed.period)
        self._plain.ties.follow(model, (q, v, a))
        few = self._few(rows)
        return q[few], v[few], a[few]

    def _few(self, rows: int) -> slice:
        return slice(None, None, max(len(self.fed.time) // rows, 1))

    def _needs(
        self, reading: Reading, actuators: list[str], path: tuple[FloatArray, ...]
    ) -> dict[str, FloatArray]:
        """Of inverse dynamics, with another gravity and a load."""
        work = self._plain
        model, gravity = work.model, work.model.opt.gravity.copy()
        model.opt.gravity[:] = reading.gravity * gravity
        if reading.load is not None:
            body, load = reading.load
            bare = inertials(model)[body]
            set_inertials(model, body, bare + point_mass(load[0], load[1:]))
        needs = efforts_along(work, actuators, *path)
        model.opt.gravity[:] = gravity
        if reading.load is not None:
            set_inertials(model, body, bare)
        return needs

    def _share(
        self, actuator: str, effort: FloatArray, need: FloatArray, speed: FloatArray, rows: int
    ) -> float:
        """Of one effort: what friction that resists, and an offset, leave beside what it needs.

        None of one that never changes: it tells nothing, and its spread is rounding.
        """
        if float(np.ptp(effort)) <= ROUNDING * float(np.max(np.abs(effort))):
            return 0.0
        model = self.rig.model
        own = speed[:, int(model.joint(driven_joint(model, actuator)).dofadr[0])]
        gain = float(model.actuator(actuator).gear[0] * model.actuator(actuator).gainprm[0])
        quiet = QUIET * max(float(np.max(np.abs(own))), 1e-30)
        one = np.ones_like(own)
        basis = np.stack([own / gain, np.tanh(own / quiet) / gain, one, -one], axis=1)
        effort = effort[self._few(rows)]
        scale = np.maximum(np.linalg.norm(basis, axis=0), 1e-30)
        _, rest = nnls(basis / scale, effort - need)
        spread = float(np.linalg.norm(effort - np.mean(effort)))
        return float(rest) / max(spread, 1e-30)


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
