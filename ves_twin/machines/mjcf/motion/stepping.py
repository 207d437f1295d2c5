"""motion_of_drive: the joints' motion under recorded commands, or under a controller."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import mujoco
import numpy as np

from ves_twin.core.engine_log import log_engine
from ves_twin.core.types import FloatArray
from ves_twin.core.units import to_si
from ves_twin.effects.effect import Effect
from ves_twin.effects.element import Element
from ves_twin.machines.mjcf.motion.filtered import fill_filters
from ves_twin.machines.mjcf.motion.started import first_state, lead_rows, read_from, start_signal
from ves_twin.machines.mjcf.motion.stepper import CARRIED, Stepper
from ves_twin.machines.mjcf.motion.work import SMOOTH, Work, sensor_rows, variables
from ves_twin.machines.mjcf.parts.joint_units import joint_units
from ves_twin.machines.mjcf.parts.loops import assemble
from ves_twin.machines.mjcf.rig.description import Controller, Mode

CHECKED = 50
"""Rows after which it is looked whether the engine gave up: a look costs as much as a step."""

FAILED = (
    mujoco.mjtWarning.mjWARN_BADQPOS,
    mujoco.mjtWarning.mjWARN_BADQVEL,
    mujoco.mjtWarning.mjWARN_BADQACC,
    mujoco.mjtWarning.mjWARN_BADCTRL,
)
"""After these MuJoCo goes on from its reference state, or without commands: not what was asked."""


@dataclass(frozen=True)
class Motion:
    """What was simulated.

    Attributes:
        work: with the model.
        path: positions and speeds (n, nq + nv).
        sensed: all sensors (n, all).
        commands: as they reached the actuators (n, nu).
    """

    work: Work
    path: FloatArray
    sensed: FloatArray
    commands: FloatArray

    @cached_property
    def signals(self) -> dict[str, FloatArray]:
        """Signals (n, w) that the rig's description compares."""
        return _signals(self.work, self.path, self.sensed, self.commands)

    @property
    def variables(self) -> Mapping[str, FloatArray]:
        """What laws depend on, by name (n,)."""
        model, told = self.work.model, self.work.rig.description
        return variables(model, self.work.programme.time, self.path) | {
            f"command@{name}": self.commands[:, model.actuator(name).id]
            for name in (*told.drive.actuators, *told.controllers)
        }


class Loop(Protocol):
    """A program that commands one actuator, row by row."""

    actuator: int
    """Number in the model."""

    def command(self, row: int, data: mujoco.MjData) -> float:
        """Its command from a row on, by the true state there."""


def motion_of_drive(
    work: Work, mode: Mode, refined: bool = False, programs: Sequence[Loop] = ()
) -> Motion:
    """What the rig's description compares, by forward simulation.

    Row k holds the state at t_k; its command acts from then on. The model's step is the whole part
    of a row's period nearest to the model's own, half of it if refined. Under recorded commands
    rows of the lead have the state of the first row after it.

    Args:
        work: what is simulated.
        mode: CONTROL feeds recorded commands, REFERENCE set-points of the controllers.
        refined: with half the step.
        programs: in place of commands or of the file's controllers.

    Returns:
        The motion; NaN throughout where it diverged and MuJoCo had to start it anew.
    """
    log_engine()
    model, period = work.model, work.period
    steps = max(1, round(period / model.opt.timestep)) * (2 if refined else 1)
    model.opt.timestep = period / steps
    closed = mode is Mode.REFERENCE or bool(programs)
    first = 0 if closed else lead_rows(work.rig, work.programme.time)
    state = _start(work, first)
    told = work.rig.description.controllers
    own = [_Pd(work, name, c) for name, c in told.items()] if mode is Mode.REFERENCE else []
    path, sensed, commands = _stepped(
        work, state, steps, first, (programs or own) if closed else None
    )
    if _failed(state):
        path, sensed = np.full_like(path, np.nan), np.full_like(sensed, np.nan)
        commands = np.full_like(commands, np.nan)
    return Motion(work, path, sensed, commands)


def _failed(data: mujoco.MjData) -> bool:
    return any(data.warning[kind].number for kind in FAILED)


def _start(work: Work, first: int) -> mujoco.MjData:
    """State of the first row that is simulated."""
    data = work.data
    data.time = first * work.period
    for joint in work.rig.description.start:
        at = work.model.joint(joint)
        position, speed = _measured_start(work, joint, first)
        data.qpos[at.qposadr[0]] = position + work.values.get(f"start@{joint}:position", 0.0)
        data.qvel[at.dofadr[0]] = speed + work.values.get(f"start@{joint}:speed", 0.0)
    begun = [int(work.model.joint(joint).dofadr[0]) for joint in work.rig.description.start]
    assemble(work.model, data, np.array(begun, int))
    warm = data.qacc_warmstart.copy()
    mujoco.mj_forward(work.model, data)  # what ends the engine ends compiled code without a word
    data.qacc_warmstart[:] = warm
    return data


def _measured_start(work: Work, joint: str, first: int) -> tuple[float, float]:
    """Given by the file, or by the first rows of the joint's signal that are simulated.

    Of what its sensor saw: an offset that is read with it is none of the joint.
    """
    told = work.rig.description
    start = told.start[joint]
    if (recorded := work.programme.drive.get(start_signal(joint))) is not None:
        return float(recorded[0, 0]), float(recorded[0, 1])
    if start.position != "measured":
        units, what = joint_units(work.model, joint), f"start.{joint}"
        at = to_si(start.position, units[0], f"{what}.position")
        return at, to_si(start.speed, units[1], f"{what}.speed")
    signal, is_speed = read_from(told, joint)
    sign = told.compare[signal].sign if signal in told.compare else 1
    column = sign * work.seen(signal)[first:, 0]
    if is_speed:
        return float(work.model.qpos0[work.model.joint(joint).qposadr[0]]), float(column[0])
    return first_state(column, work.period, told.drive.smoothing)


def _led(rows: FloatArray, first: int) -> FloatArray:
    """Rows (n, w) behind those of the lead, which have what the first of them has."""
    return np.concatenate([np.repeat(rows[:1], first, axis=0), rows])


def _commands(work: Work) -> FloatArray:
    """Commands (n, nu) that reach the actuators."""
    commands = np.zeros((len(work.programme.time), work.model.nu))
    fed = work.rig.description.drive.actuators
    sent = {name: work.programme.drive[signal][:, 0] for name, signal in fed.items()}
    for name, column in sent.items():
        at = work.model.actuator(name).id
        commands[:, at] = work.command(name, column) + work.picked_up(name, sent)
    return commands


class _Pd:
    """One controller with the memory that its rate needs."""

    def __init__(self, work: Work, actuator: str, told: Controller) -> None:
        self.told, self.actuator = told, work.model.actuator(actuator).id
        self.at = int(work.model.joint(told.joint).qposadr[0])
        self.dof = int(work.model.joint(told.joint).dofadr[0])
        self.reference = work.programme.drive[told.reference][:, 0].tolist()
        self.period = work.period
        self.last: list[float] = []
        self.mean = 0.0

    def command(self, row: int, data: mujoco.MjData) -> float:
        told, q = self.told, float(data.qpos[self.at])
        self.last = [*self.last[1 - told.average :], q] if told.average > 1 else [q]
        mean = sum(self.last) / len(self.last)
        rate = (mean - self.mean) / self.period if row else float(data.qvel[self.dof])
        self.mean = mean
        u = told.kp * (self.reference[row] - q) - told.kd * rate
        return float(min(max(u, -told.limit), told.limit))


def _stepped(
    work: Work, data: mujoco.MjData, steps: int, first: int, loops: Sequence[Loop] | None
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Path, sensors and commands: under controllers row by row, or under commands for None."""
    model, rows, closed = work.model, len(work.programme.time), loops is not None
    asked = np.zeros((rows, model.nu)) if closed else _commands(work)
    run = Stepper.of(work, data, steps, asked.copy())
    run.imposed.begin(data, first * steps)
    if not closed:
        fill_filters(model, data, asked[: first + 1], work.period)
    hooks = _Hooks(work)
    if not (closed or hooks.any):
        run.advance(first * steps, rows * steps)
    reach = _Reach(work)
    for k in range(first, rows) if closed or hooks.any else ():
        run.imposed.move(data, k * steps)
        for loop in loops or ():
            asked[k, loop.actuator] = loop.command(k, data)
        run.commands[k] = reach.at(asked[k], k) if closed else asked[k]
        for n in range(k * steps, (k + 1) * steps) if hooks.any else ():
            run.own[:] = hooks.efforts(data)
            run.advance(n, n + 1)
        if not hooks.any:
            run.advance(k * steps, (k + 1) * steps)
        if k % CHECKED == 0 and _failed(data):
            break
    path, sensed, pull = (_led(one[first:], first) for one in (run.path, run.sensed, run.pull))
    for name, command in run.imposed.commands(path, pull).items():
        asked[:, model.actuator(name).id] = command
    return path, sensed, asked


class _Hooks:
    """Efforts of kinds with hooks of their own, which compiled code does not know."""

    def __init__(self, work: Work) -> None:
        joints = [(e, p) for e, p in work.effects if e.element is Element.JOINT]
        at = {e.target: work.model.joint(e.parts[0]) for e, _ in joints}
        place = {name: (int(j.dofadr[0]), int(j.qposadr[0])) for name, j in at.items()}
        self.resists = [
            (*place[e.target], e.resist, SMOOTH * p.speed)
            for e, p in joints
            if type(e).resist is not Effect.resist
        ]
        self.holders = [
            (*place[e.target], e.holder()) for e, _ in joints if type(e).holder is not Effect.holder
        ]
        self.carries = [
            (*place[e.target], e.carry, SMOOTH * p.speed)
            for e, p in joints
            if type(e).carry is not Effect.carry
        ]
        self.any = bool(self.resists or self.holders or self.carries)

    def efforts(self, data: mujoco.MjData) -> FloatArray:
        """What they add to the efforts of the joints now (nv,)."""
        total = np.zeros(len(data.qvel))
        for dof, _, resist, slow in self.resists:
            total[dof] -= float(resist(data.qvel[[dof]], slow)[0])
        for dof, place, holder in self.holders:
            total[dof] -= holder(float(data.qpos[place]))
        for dof, _, carry, slow in self.carries:
            friction = np.zeros(1)
            for _ in range(CARRIED):
                friction = carry(data.qfrc_actuator[[dof]] - friction, data.qvel[[dof]], slow)
            total[dof] -= float(friction[0])
        return total


class _Reach:
    """Commands of a closed loop as they reach the actuators, row by row, effect after effect."""

    def __init__(self, work: Work) -> None:
        self.time, model = work.programme.time, work.model
        self.chain = [
            (effect, model.actuator(effect.parts[0]).id, np.zeros(len(self.time)))
            for effect, _ in work.effects
            if effect.element is Element.ACTUATOR
        ]
        self.talks = [(e, i) for e, i, _ in self.chain if type(e).pick_up is not Effect.pick_up]
        self.names = {model.actuator(i).name: i for i in range(model.nu)}

    def at(self, asked: FloatArray, row: int) -> FloatArray:
        reach = asked.copy()
        for effect, i, given in self.chain:
            given[row] = reach[i]
            reach[i] = effect.edit_row(given, self.time, row)
        for effect, i in self.talks:
            reach[[i]] += effect.pick_up({name: asked[[j]] for name, j in self.names.items()})
        return reach


def _signals(
    work: Work, path: FloatArray, sensed: FloatArray, commands: FloatArray
) -> dict[str, FloatArray]:
    model, found = work.model, {}
    for name, compared in work.rig.description.compare.items():
        if compared.sensor:
            rows = sensor_rows(model, sensed, compared)
        elif compared.actuator:
            rows = commands[:, [model.actuator(compared.actuator).id]]
        elif compared.of == "position":
            at = int(model.joint(compared.joint).qposadr[0])
            rows = work.position(compared.joint, path[:, at])[:, None]
        else:
            rows = path[:, [model.nq + int(model.joint(compared.joint).dofadr[0])]]
        found[name] = compared.sign * rows
    return found
