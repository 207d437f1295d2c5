"""motion_of_drive: the joints' motion under recorded commands, or under a controller."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import mujoco
import numpy as np
from mujoco import rollout

from ves_twin.core.engine_log import log_engine
from ves_twin.core.types import FloatArray
from ves_twin.core.units import to_si
from ves_twin.effects.effect import Effect
from ves_twin.effects.element import Element
from ves_twin.machines.mjcf.motion.filtered import fill_filters
from ves_twin.machines.mjcf.motion.imposed import Imposed
from ves_twin.machines.mjcf.motion.law_loop import compiled_laws, lawful_rows, push
from ves_twin.machines.mjcf.motion.started import first_state, lead_rows, read_from, start_signal
from ves_twin.machines.mjcf.motion.work import Work, sensor_rows, variables
from ves_twin.machines.mjcf.parts.joint_units import joint_units
from ves_twin.machines.mjcf.parts.loops import assemble
from ves_twin.machines.mjcf.rig.description import Controller, Mode

CHECKED = 50
"""Rows after which it is looked whether the engine gave up: a look costs as much as a step."""

CARRIED = 4
"""Iterations of a friction that its load makes: of a tenth of the load it is then known to 1e-4."""

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
    model, period = work.model, work.programme.period
    steps = max(1, round(period / model.opt.timestep)) * (2 if refined else 1)
    model.opt.timestep = period / steps
    drive = work.rig.description.drive
    closed = mode is Mode.REFERENCE or bool(programs)
    first = 0 if closed else lead_rows(work.rig, work.programme.time)
    state = _start(work, first)
    if not (closed or drive.imposed or drive.locked or _resisted(work)):
        path, sensed, commands = _open(work, state, steps, first)
    else:
        told = work.rig.description.controllers
        own = [_Pd(work, name, c) for name, c in told.items()] if mode is Mode.REFERENCE else []
        loops = (programs or own) if closed else None
        path, sensed, commands = _stepped(work, state, steps, first, loops)
    if _failed(state):
        path, sensed = np.full_like(path, np.nan), np.full_like(sensed, np.nan)
        commands = np.full_like(commands, np.nan)
    return Motion(work, path, sensed, commands)


def _failed(data: mujoco.MjData) -> bool:
    return any(data.warning[kind].number for kind in FAILED)


def _start(work: Work, first: int) -> mujoco.MjData:
    """State of the first row that is simulated."""
    data = work.data
    data.time = first * work.programme.period
    for joint in work.rig.description.start:
        at = work.model.joint(joint)
        position, speed = _measured_start(work, joint, first)
        data.qpos[at.qposadr[0]] = position + work.values.get(f"start@{joint}:position", 0.0)
        data.qvel[at.dofadr[0]] = speed + work.values.get(f"start@{joint}:speed", 0.0)
    begun = [int(work.model.joint(joint).dofadr[0]) for joint in work.rig.description.start]
    assemble(work.model, data, np.array(begun, int))
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
    return first_state(column, work.programme.period, told.drive.smoothing)


def _resisted(work: Work) -> bool:
    """Whether an effect depends on speed or place in a way that the model itself lacks."""
    plain = (Effect.resist, Effect.hold, Effect.carry)
    return any(
        (type(e).resist, type(e).hold, type(e).carry) != plain and not e.steady
        for e, _ in work.effects
    )


def _carried(work: Work, joint: str, given: FloatArray, speed: FloatArray) -> float:
    """Friction by a joint's load where the effort that is given (1,) holds both: by iteration."""
    friction = np.zeros(1)
    for _ in range(CARRIED):
        friction = work.carried(joint, given - friction, speed)
    return float(friction[0])


def _steady(work: Work) -> FloatArray:
    """Efforts (nv,) of the effects that are the same at any speed."""
    effort, still = np.zeros(work.model.nv), np.zeros(1)
    for name in {e.parts[0] for e, _ in work.effects if e.steady}:
        effort[int(work.model.joint(name).dofadr[0])] -= work.resistance(name, still)[0]
    return effort


def _open(
    work: Work, data: mujoco.MjData, steps: int, first: int
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Recorded commands, stepped by MuJoCo's own loop."""
    model = work.model
    every = _commands(work)
    commands = every[first:]
    fill_filters(model, data, every[: first + 1], work.programme.period)
    laws = compiled_laws(work.laws, model)
    if len(laws.codes):
        path, sensed = lawful_rows(model, data, commands, _steady(work), steps, laws)
        return _led(path, first), _led(sensed, first), every
    size = mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    state = np.zeros(size)
    mujoco.mj_getState(model, data, state, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    steady = np.tile(_steady(work), (len(commands), 1))
    control = np.repeat(np.hstack([commands, steady]), steps, axis=0)[None]
    fed = mujoco.mjtState.mjSTATE_CTRL | mujoco.mjtState.mjSTATE_QFRC_APPLIED
    states, sensors = rollout.rollout(
        model, data, initial_state=state[None], control=control, control_spec=int(fed)
    )
    rows = np.concatenate([state[None], states[0][steps - 1 :: steps][:-1]])
    path = rows[:, 1 : 1 + model.nq + model.nv]
    return _led(path, first), _led(np.asarray(sensors[0][::steps]), first), every


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
        self.period = work.programme.period
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
    """Row by row, with controllers, or commands for None, and efforts that follow the speed."""
    model, rows = work.model, len(work.programme.time)
    closed = loops is not None
    asked = np.zeros((rows, model.nu)) if closed else _commands(work)
    resisted = [
        (name, int(model.joint(name).dofadr[0]), int(model.joint(name).qposadr[0]))
        for name in {e.parts[0] for e, _ in work.effects if e.element is Element.JOINT}
    ]
    at_joint = {n: [e for e, _ in work.at(Element.JOINT, n)] for n, _, _ in resisted}
    holders = {
        n: [e.holder() for e in found if type(e).holder is not Effect.holder]
        for n, found in at_joint.items()
    }
    resists = {n: work.resists(n) for n, _, _ in resisted}
    path, sensed = np.zeros((rows, model.nq + model.nv)), np.zeros((rows, model.nsensordata))
    pull, imposed = np.zeros((rows, model.nv)), Imposed.of(work, steps)
    speed, given, reach = np.zeros(1), np.zeros(1), _Reach(work)
    loaded = {e.parts[0] for e, _ in work.effects if type(e).carry is not Effect.carry}
    laws, own = compiled_laws(work.laws, model), np.zeros(model.nv)
    imposed.begin(data, first * steps)
    if not closed:
        fill_filters(model, data, asked[: first + 1], work.programme.period)
    for k in range(first, rows):
        imposed.move(data, k * steps)
        path[k, : model.nq], path[k, model.nq :] = data.qpos, data.qvel
        for loop in loops or ():
            asked[k, loop.actuator] = loop.command(k, data)
        data.ctrl[:] = reach.at(asked[k], k) if closed else asked[k]
        for n in range(steps):
            data.qfrc_applied[:] = 0.0
            for name, dof, at in resisted:
                speed[0], q = data.qvel[dof], float(data.qpos[at])
                effort = sum(float(resist(speed)[0]) for resist in resists[name])
                effort += sum(holder(q) for holder in holders[name])
                given[0] = data.qfrc_actuator[dof]
                effort += _carried(work, name, given, speed) if name in loaded else 0.0
                data.qfrc_applied[dof] = -effort
            if len(laws.codes):
                push(laws, data, own)
            begun = imposed.step(model, data, k * steps + n)
            if n == 0:
                sensed[k], pull[k] = data.sensordata, begun
        if k % CHECKED == 0 and _failed(data):
            break
    path, sensed, pull = (_led(one[first:], first) for one in (path, sensed, pull))
    for name, command in imposed.commands(path, pull).items():
        asked[:, model.actuator(name).id] = command
    return path, sensed, asked


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
