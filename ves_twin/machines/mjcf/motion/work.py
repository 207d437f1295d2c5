"""Work: one prediction under way: the edited model, what acts on it, and what was fed in."""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from threading import get_ident

import mujoco
import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.effects.effect import Effect
from ves_twin.effects.element import Element
from ves_twin.effects.joints import CoulombFriction
from ves_twin.effects.law import Law, LawKind, LawShape, joints_of, variable_along
from ves_twin.effects.place import Place
from ves_twin.machines.mjcf.parts.ties import Ties
from ves_twin.machines.mjcf.rig.description import Compared
from ves_twin.machines.mjcf.rig.machine import Rig
from ves_twin.machines.mjcf.rig.places import SINGLE, tendon_joints, typical_speed
from ves_twin.machines.mjcf.rig.tied import ties_of

SMOOTH = 0.0005
"""Share of the typical speed over which a sign is smoothed, chosen on EMPS: four times as much
makes its 20 N of dry friction read 0.8 % high and its 200 N s/m of damping 0.8 % low."""

KEPT = 4
"""Rigs, and threads, whose data MuJoCo need not make anew."""


@dataclass(frozen=True)
class Work:
    """What a prediction needs.

    Attributes:
        rig: whose prediction.
        programme: what is fed in.
        model: with effects of the model.
        effects: all that are at work.
        values: parameter -> value.
        laws: of the rig's file, and others.
        stretch: of time, where the log's clock runs off.
    """

    rig: Rig
    programme: Excitation
    model: mujoco.MjModel
    effects: tuple[tuple[Effect, Place], ...]
    values: Mapping[str, float]
    laws: tuple[Law, ...] = ()
    stretch: float = 1.0

    @staticmethod
    def begin(
        rig: Rig,
        programme: Excitation,
        values: Mapping[str, float],
        laws: Sequence[Law] = (),
    ) -> Work:
        """A copy of the rig's model with the effects that the values say; laws beside its own."""
        effects = tuple(rig.effects_at(values))
        model = copy.copy(rig.model)
        for effect, _ in effects:
            effect.edit_model(model)
        factors = [(told, values.get(told.name, 0.0)) for told in rig.promoted]
        named = (told.scaled(factor).law for told, factor in factors if factor != 0.0)
        every = (*rig.laws, *named, *laws)
        stretch = float(model.opt.timestep / rig.model.opt.timestep)
        work = Work(rig, programme, model, effects, values, every, stretch)
        if effects:
            mujoco.mj_setConst(model, work.data)
        return work

    @property
    def data(self) -> mujoco.MjData:
        """Of the model, in its default state; what was there of another prediction is gone."""
        data = _data(self.rig.model, get_ident())
        mujoco.mj_resetData(self.model, data)
        return data

    @cached_property
    def ties(self) -> Ties:
        """Joints that follow those whose motion is fed in."""
        return ties_of(self.rig.description, self.rig.model)

    @property
    def period(self) -> float:
        """Time that a row takes in the machine [s]."""
        return self.programme.period * self.stretch

    def at(self, element: Element, name: str) -> list[tuple[Effect, Place]]:
        """Effects on one target."""
        return self._parts.get((element, name), [])

    @cached_property
    def _parts(self) -> dict[tuple[Element | None, str], list[tuple[Effect, Place]]]:
        """Effects by what they sit on, in their order."""
        found: dict[tuple[Element | None, str], list[tuple[Effect, Place]]] = {}
        for effect, place in self.effects:
            found.setdefault((effect.element, effect.parts[0]), []).append((effect, place))
        return found

    def resistance(self, joint: str, speed: FloatArray) -> FloatArray:
        """Effort [N, N m] against motion of a joint that the model itself lacks (n,)."""
        total = np.zeros_like(speed)
        for effect, place in self.at(Element.JOINT, joint):
            total = total + effect.resist(speed, SMOOTH * place.speed)
        return total

    def carried(self, joint: str, load: FloatArray, speed: FloatArray) -> FloatArray:
        """Effort [N, N m] against motion of a joint that its load makes (n,)."""
        total = np.zeros_like(load)
        for effect, place in self.at(Element.JOINT, joint):
            total = total + effect.carry(load, speed, SMOOTH * place.speed)
        return total

    def dry(self, joint: str, speed: FloatArray) -> FloatArray:
        """The model's friction loss along a given motion: level * tanh(v / slow) (n,)."""
        level = CoulombFriction(joint).present(self.model)
        if level == 0.0:
            return np.zeros_like(speed)
        return np.asarray(level * np.tanh(speed / (SMOOTH * self._typical_speed(joint))))

    def _typical_speed(self, joint: str) -> float:
        """Of a joint [m/s or rad/s]; of one that follows and says none that of its leader."""
        for one in self.ties.followers:
            untold = joint not in self.rig.description.typical.joint and one.powers[1] != 0.0
            if one.joint == joint and untold:
                return abs(one.powers[1]) * self._typical_speed(one.leader)
        return typical_speed(joint, self.rig.description, self.model)

    def held(self, joint: str, position: FloatArray) -> FloatArray:
        """Effort [N, N m] against a joint along given positions (n,)."""
        total = np.zeros_like(position)
        for effect, _ in self.at(Element.JOINT, joint):
            total = total + effect.hold(position)
        return total

    def coupled(self, joint: str, speed: FloatArray) -> FloatArray:
        """Effort of the fixed tendons over a joint against given speeds (n, nv): (n,).

        Damping, and friction loss as `dry` has it, of each tendon's own speed.
        """
        model, total = self.model, np.zeros(len(speed))
        for number in _resisting(model):
            damping = float(model.tendon_damping[number])
            level = float(model.tendon_frictionloss[number])
            parts = tendon_joints(model, number)
            share = dict(parts).get(joint, 0.0)
            if share == 0.0:
                continue
            own = sum(c * speed[:, int(model.joint(j).dofadr[0])] for j, c in parts)
            effort = damping * own
            if level != 0.0:
                typical = (abs(c) * typical_speed(j, self.rig.description, model) for j, c in parts)
                effort = effort + level * np.tanh(own / (SMOOTH * sum(typical)))
            total = total + share * effort
        return total

    def lawful(self, joint: str, along: Mapping[str, FloatArray]) -> FloatArray:
        """Effort [N, N m] of the laws at a joint along variables (n,) each."""
        total = np.zeros(len(self.programme.time))
        for law in self.laws:
            sign = dict(joints_of(law.place)).get(joint, 0.0)
            if law.kind is not LawKind.EFFORT or not sign:
                continue
            of = [variable_along(name, along) for name in law.of]
            stop = law.shape is LawShape.STOP
            effort = law.stopped(of[0], along[f"speed@{joint}"]) if stop else law.at(*of)
            total = total + sign * effort
        return total

    def position(self, joint: str, position: FloatArray) -> FloatArray:
        """A joint's position behind the effects between it and where it is measured (n,)."""
        for effect, _ in self.at(Element.JOINT, joint):
            position = effect.edit_position(position)
        return position

    def command(self, actuator: str, command: FloatArray) -> FloatArray:
        """What reaches an actuator (n,)."""
        for effect, _ in self.at(Element.ACTUATOR, actuator):
            command = effect.edit_command(command, self.programme.time)
        return command

    def picked_up(self, actuator: str, commands: Mapping[str, FloatArray]) -> FloatArray | float:
        """What reaches an actuator of the commands to others (n,)."""
        return sum(e.pick_up(commands) for e, _ in self.at(Element.ACTUATOR, actuator))

    def required(self, actuator: str, effort: FloatArray) -> FloatArray:
        """The command that an actuator needs (n,)."""
        for effect, _ in reversed(self.at(Element.ACTUATOR, actuator)):
            effort = effect.edit_required(effort, self.programme.time)
        return effort

    def reading(self, signal: str, true: FloatArray) -> FloatArray:
        """What is recorded of a signal (n, w)."""
        reading = true
        for effect, place in self._of_signal(signal):
            reading = effect.edit_reading(reading, true, self.programme.time, place)
        return reading

    def seen(self, signal: str) -> FloatArray:
        """What a sensor saw (n, w) of what was recorded of it and is fed in."""
        recorded = self.programme.drive[signal]
        for effect, place in reversed(self._of_signal(signal)):
            recorded = effect.undo_reading(recorded, self.programme.time, place)
        return recorded

    def _of_signal(self, signal: str) -> list[tuple[Effect, Place]]:
        """Effects on a signal, one of its columns, or the part whose signal it is."""
        return [
            (effect, place)
            for effect, place in self.effects
            if effect.element is Element.SIGNAL
            and (_covers(effect.target, signal) or _of(effect.target, signal))
        ]


def _resisting(model: mujoco.MjModel) -> list[int]:
    """Tendons with damping or friction loss."""
    found = np.logical_or(model.tendon_damping, model.tendon_frictionloss)
    return [int(number) for number in np.flatnonzero(found)]


@lru_cache(maxsize=KEPT)
def _data(model: mujoco.MjModel, thread: int) -> mujoco.MjData:
    """Made once: that takes longer than a hundred steps, and effects leave all sizes alone."""
    return mujoco.MjData(model)


def variables(model: mujoco.MjModel, time: FloatArray, path: FloatArray) -> dict[str, FloatArray]:
    """Time [s], position and speed of every hinge and slide (n,), of states (n, nq + nv)."""
    found = {"time": time - time[0]}
    for number in range(model.njnt):
        joint = model.joint(number)
        if int(joint.type[0]) in SINGLE:
            found[f"position@{joint.name}"] = path[:, int(joint.qposadr[0])]
            found[f"speed@{joint.name}"] = path[:, model.nq + int(joint.dofadr[0])]
    return found


def measured_variables(work: Work, path: FloatArray) -> dict[str, FloatArray]:
    """The same of a measured motion, and what is fed to actuators; to others nothing is (n,)."""
    told, fed, model = work.rig.description, work.programme.drive, work.model
    found = variables(model, work.programme.time, path)
    every = (model.actuator(number).name for number in range(model.nu))
    found |= {f"command@{name}": np.zeros(len(path)) for name in every}
    commands = {n: fed[signal][:, 0] for n, signal in told.drive.actuators.items() if signal in fed}
    return found | {f"command@{name}": column for name, column in commands.items()}


def _covers(target: str, signal: str) -> bool:
    """Whether a target is the signal, or the part whose signal it is."""
    return target in (signal, signal.partition(".")[0])


def _of(target: str, signal: str) -> bool:
    rest = target.removeprefix(f"{signal}.")
    return rest != target and rest.replace(".", "").isdigit()


def sensor_rows(model: mujoco.MjModel, sensordata: FloatArray, compared: Compared) -> FloatArray:
    """Columns of a named sensor (n, w) out of all sensor data (n, all), or of its axis."""
    sensor = model.sensor(compared.sensor)
    first, width = int(sensor.adr[0]), int(sensor.dim[0])
    if compared.axis:
        first, width = first + "xyz".index(compared.axis), 1
    return np.asarray(sensordata[:, first : first + width])
