"""Stepper: MuJoCo's steps under commands, laws, resistances and imposed motion, compiled."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import mujoco
import numpy as np

from ves_twin.core.compiled import compiled, say_that_it_compiles
from ves_twin.core.types import FloatArray, IntArray
from ves_twin.effects.element import Element
from ves_twin.effects.law import Law, LawKind
from ves_twin.effects.law_kernel import CompiledLaws, law_efforts
from ves_twin.effects.resistance import NUMBERS, Form, of_load, of_place, of_speed
from ves_twin.machines.mjcf.motion.imposed import STAGED, Imposed
from ves_twin.machines.mjcf.motion.work import SMOOTH, Work
from ves_twin.simulator.engine import address_of, call_engine, handles

CARRIED = 4
"""Iterations of a friction that its load makes: of a tenth of the load it is then known to 1e-4."""

FORM, DOF, PLACE = range(3)
"""Columns of a resistance's code."""


class _Resisting(NamedTuple):
    """Resistances as numbers.

    Attributes:
        codes: form, number of the joint in qvel and in qpos (k, 3).
        numbers: of the forms (k, 4).
        slow: speeds over which signs are smoothed (k,).
        memory: what they remember from step to step (k, 2).
    """

    codes: IntArray
    numbers: FloatArray
    slow: FloatArray
    memory: FloatArray

    @staticmethod
    def of(work: Work) -> _Resisting:
        """Those of a prediction's effects."""
        model = work.model
        found = [
            (effect.resistance, model.joint(effect.parts[0]), SMOOTH * place.speed)
            for effect, place in work.effects
            if effect.element is Element.JOINT and effect.resistance.form is not Form.NONE
        ]
        codes = [(int(r.form), int(j.dofadr[0]), int(j.qposadr[0])) for r, j, _ in found]
        return _Resisting(
            np.array(codes, np.int64).reshape(-1, 3),
            np.array([r.row for r, _, _ in found]).reshape(-1, NUMBERS),
            np.array([slow for *_, slow in found]),
            np.full((len(found), 2), np.nan),
        )


class _Pushed(NamedTuple):
    """Imposed motion as compiled loops take it.

    Attributes:
        places, dofs: addresses of the imposed coordinates in qpos and qvel.
        position, speed: of them at each step (steps, k).
        pull, begun: efforts [N, N m] that accelerate their inertia, held from there on, and at
            each step (steps, k).
        staged: whether the integrator leaves the last of its looks behind in the data.
        begin_qacc: accelerations (nv,) at the begin of the last step, where it is staged.
    """

    places: IntArray
    dofs: IntArray
    position: FloatArray
    speed: FloatArray
    pull: FloatArray
    begun: FloatArray
    staged: bool
    begin_qacc: FloatArray

    @staticmethod
    def of(imposed: Imposed) -> _Pushed:
        """Of one prediction."""
        model, mass = imposed.work.model, imposed.inertia
        staged = bool(model.opt.integrator == STAGED and len(imposed.dofs))
        return _Pushed(
            imposed.places, imposed.dofs, imposed.position, imposed.speed,
            mass * imposed.pull, mass * imposed.begun, staged, np.zeros(model.nv),
        )  # fmt: skip


class _State(NamedTuple):
    """Views of MuJoCo's data."""

    qpos: FloatArray
    qvel: FloatArray
    qacc: FloatArray
    ctrl: FloatArray
    applied: FloatArray
    smooth: FloatArray
    actuator: FloatArray
    sensors: FloatArray


class _Rows(NamedTuple):
    """What was found, by rows: see `Stepper`."""

    path: FloatArray
    sensed: FloatArray
    pull: FloatArray


@dataclass(frozen=True)
class Stepper:
    """A simulation under way.

    Attributes:
        work: what is simulated.
        data: its state.
        steps: of the model in a row.
        commands: as they reach the actuators (n, nu); a row is read when the motion is there.
        imposed: joints that move as recorded.
        own: further efforts (nv,), added to what is applied in each step.
        path: positions and speeds (n, nq + nv), filled as the motion goes on.
        sensed: all sensors (n, all).
        pull: accelerations (n, nv).
    """

    work: Work
    data: mujoco.MjData
    steps: int
    commands: FloatArray
    imposed: Imposed
    own: FloatArray
    path: FloatArray
    sensed: FloatArray
    pull: FloatArray
    _laws: CompiledLaws
    _lawful: FloatArray
    _resisting: _Resisting
    _pushed: _Pushed

    @staticmethod
    def of(work: Work, data: mujoco.MjData, steps: int, commands: FloatArray) -> Stepper:
        """Of a prediction whose data is in its first state."""
        say_that_it_compiles(_advance, "some 15 s")
        model, rows, imposed = work.model, len(commands), Imposed.of(work, steps)
        return Stepper(
            work, data, steps, commands, imposed, np.zeros(model.nv),
            np.zeros((rows, model.nq + model.nv)), np.zeros((rows, model.nsensordata)),
            np.zeros((rows, model.nv)), _compiled(work.laws, model), np.zeros(model.nv),
            _Resisting.of(work), _Pushed.of(imposed),
        )  # fmt: skip

    def advance(self, first: int, last: int) -> None:
        """From one step of the model to another one, counted from the begin of the record."""
        data, model = self.data, self.work.model
        state = _State(
            data.qpos, data.qvel, data.qacc, data.ctrl, data.qfrc_applied, data.qfrc_smooth,
            data.qfrc_actuator, data.sensordata,
        )  # fmt: skip
        _advance(
            address_of("mj_step"), address_of("mj_forward"), *handles(model, data), first, last,
            self.steps, float(model.opt.timestep), self.commands, state, self._laws,
            self._resisting, self._pushed, self.own, self._lawful,
            _Rows(self.path, self.sensed, self.pull),
        )  # fmt: skip


def _compiled(laws: Sequence[Law], model: mujoco.MjModel) -> CompiledLaws:
    """Those of efforts among the laws, in a model that has their joints and actuators."""

    def variable(what: str, name: str) -> int:
        if what == "command":
            return int(model.actuator(name).id)
        joint = model.joint(name)
        return int(joint.qposadr[0] if what == "position" else joint.dofadr[0])

    acting = [law for law in laws if law.kind is LawKind.EFFORT]
    return CompiledLaws.of(acting, lambda name: int(model.joint(name).dofadr[0]), variable)


@compiled
def _advance(
    mj_step: int, mj_forward: int, model: int, data: int, first: int, last: int, steps: int,
    period: float, commands: FloatArray, state: _State, laws: CompiledLaws,
    resisting: _Resisting, pushed: _Pushed, own: FloatArray, lawful: FloatArray, rows: _Rows,
) -> None:  # fmt: skip
    width, imposed = len(state.qpos), len(pushed.dofs) > 0
    for n in range(first, last):
        row = n // steps
        if imposed:
            _place(pushed, n, state)
        if n % steps == 0:
            rows.path[row, :width] = state.qpos
            rows.path[row, width:] = state.qvel
            state.ctrl[:] = commands[row]
        if len(laws.codes):
            load = state.smooth - lawful
            law_efforts(n * period, state.qpos, state.qvel, state.ctrl, load, laws, lawful)
        for dof in range(len(own)):
            state.applied[dof] = own[dof] + lawful[dof]
        if len(resisting.codes):
            _resist(resisting, state)
        if imposed:
            _lead(mj_forward, model, data, pushed, n, state)
        call_engine(mj_step, model, data)
        if n % steps == 0:
            rows.sensed[row] = state.sensors
            rows.pull[row] = pushed.begin_qacc if pushed.staged else state.qacc


@compiled
def _resist(resisting: _Resisting, state: _State) -> None:
    """Subtract the efforts of all resistances from what is applied."""
    for k in range(len(resisting.codes)):
        form, dof, place = resisting.codes[k]
        numbers, slow, speed = resisting.numbers[k], resisting.slow[k], state.qvel[dof]
        effort = of_speed(form, numbers, speed, slow)
        effort += of_place(form, numbers, state.qpos[place], resisting.memory[k])
        if form == Form.BY_LOAD:
            for _ in range(CARRIED):
                effort = of_load(numbers, state.actuator[dof] - effort, speed, slow)
        state.applied[dof] -= effort


@compiled
def _lead(mj_forward: int, model: int, data: int, pushed: _Pushed, n: int, state: _State) -> None:
    """Push imposed joints through a step; where it is staged, look at its begin first."""
    if pushed.staged:
        _push(pushed.dofs, pushed.begun[n], state)
        call_engine(mj_forward, model, data)
        pushed.begin_qacc[:] = state.qacc
        _place(pushed, n, state)
    _push(pushed.dofs, pushed.pull[n], state)


@compiled
def _place(pushed: _Pushed, n: int, state: _State) -> None:
    """Set imposed joints to their recorded places and speeds."""
    for k in range(len(pushed.places)):
        state.qpos[pushed.places[k]] = pushed.position[n, k]
    for k in range(len(pushed.dofs)):
        state.qvel[pushed.dofs[k]] = pushed.speed[n, k]


@compiled
def _push(dofs: IntArray, efforts: FloatArray, state: _State) -> None:
    """Apply efforts (k,) at imposed joints, in place of what else acts there."""
    for k in range(len(dofs)):
        state.applied[dofs[k]] = efforts[k]
