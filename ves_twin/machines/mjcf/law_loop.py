"""lawful_rows: rows of a motion in which laws act at the joints, stepped in compiled code."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from ves_twin.core.compiled import compiled
from ves_twin.core.types import FloatArray, IntArray
from ves_twin.effects.law import Law, LawKind, LawShape, joints_of, parts_of
from ves_twin.simulator.engine import address_of, call_engine, handles

TIME, POSITION, SPEED, COMMAND = range(4)
"""Where a variable is read."""

SOURCES = {"time": TIME, "position": POSITION, "speed": SPEED, "command": COMMAND}

TABLE, MESH, STOP = range(3)

SHAPES = {LawShape.TABLE: TABLE, LawShape.MESH: MESH, LawShape.STOP: STOP}

SHAPE, DOF, OTHER_DOF, SIGN, FIRST_VALUE, SOURCE = range(6)
"""Columns of a code; then those of its variables."""

INDEX, OTHER, MINUS, KNOT, COUNT = range(SOURCE + 1, SOURCE + 6)
"""Further columns of the first variable; the second's are WIDTH further on."""

WIDTH = 6

NONE = -1
"""In place of a second joint."""


@dataclass(frozen=True)
class CompiledLaws:
    """Laws of efforts as numbers.

    Attributes:
        codes: shape, degree of freedom, that of a second joint and its sign, first value; then
            source, index, that of a second joint, its sign, first knot and count of each variable
            (laws, 17).
        knots, values: of all.
        plays: width of the first variable's play, and where its slider is (laws, 2).
    """

    codes: IntArray
    knots: FloatArray
    values: FloatArray
    plays: FloatArray

    @staticmethod
    def of(laws: Sequence[Law], model: mujoco.MjModel) -> CompiledLaws:
        """Those of efforts among the laws, in a model that has their joints and actuators."""
        acting = [law for law in laws if law.kind is LawKind.EFFORT]
        codes = np.zeros((len(acting), SOURCE + 2 * WIDTH), np.int64)
        knots: list[float] = []
        values: list[float] = []
        plays = np.tile([0.0, np.nan], (len(acting), 1))
        for code, law, play in zip(codes, acting, plays, strict=True):
            joints = [(int(model.joint(name).dofadr[0]), s) for name, s in joints_of(law.place)]
            code[:SOURCE] = SHAPES[law.shape], *_both(joints), len(values)
            values += law.values
            for n, variable in enumerate(law.of):
                at = SOURCE + n * WIDTH
                own = law.knots[n] if law.knots else ()
                code[at : at + WIDTH] = *_place(variable, model), len(knots), len(own)
                knots += own
            play[0] = parts_of(law.of[0])[2]
        return CompiledLaws(codes, np.array(knots, float), np.array(values, float), plays)

    def push(self, data: mujoco.MjData, own: FloatArray) -> None:
        """Put the efforts into `own` (nv,) as they are now, and add them to what is applied."""
        time = float(data.time)
        smooth = data.qfrc_smooth - own
        _efforts(
            time, data.qpos, data.qvel, data.ctrl, smooth,
            self.codes, self.knots, self.values, self.plays, own,
        )  # fmt: skip
        data.qfrc_applied[:] += own


def _both(joints: Sequence[tuple[int, float]]) -> tuple[int, int, int]:
    """Number of the first, that of the second or NONE, and the second's sign."""
    (first, _), (second, sign) = joints[0], joints[1] if len(joints) > 1 else (NONE, 0.0)
    return first, second, int(sign)


def _place(variable: str, model: mujoco.MjModel) -> tuple[int, int, int, int]:
    """Source and index of a variable, index and sign of a second joint's."""
    what, parts, _ = parts_of(variable)
    source = SOURCES[what]
    if source == TIME:
        return source, 0, NONE, 0
    if source == COMMAND:
        return source, int(model.actuator(parts[0][0]).id), NONE, 0
    joints = [(model.joint(name), sign) for name, sign in parts]
    at = [(int(j.qposadr[0] if source == POSITION else j.dofadr[0]), s) for j, s in joints]
    return source, *_both(at)


@compiled
def _interval(x: float, knots: FloatArray, first: int, count: int) -> int:
    low, high = first, first + count - 1
    while high - low > 1:
        middle = (low + high) // 2
        if knots[middle] <= x:
            low = middle
        else:
            high = middle
    return low - first


@compiled
def _variable(
    code: IntArray, n: int, time: float, qpos: FloatArray, qvel: FloatArray, ctrl: FloatArray
) -> float:
    at = n * WIDTH
    source, index, other = code[SOURCE + at], code[INDEX + at], code[OTHER + at]
    if source == POSITION:
        more = 0.0 if other == NONE else code[MINUS + at] * qpos[other]
        return float(qpos[index] + more)
    if source == SPEED:
        more = 0.0 if other == NONE else code[MINUS + at] * qvel[other]
        return float(qvel[index] + more)
    if source == COMMAND:
        return float(ctrl[index])
    return time


@compiled
def _within(play: FloatArray, x: float) -> float:
    """Where x stands in its play; the slider, which begins in the middle, is moved along."""
    if play[0] <= 0.0:
        return x
    half = 0.5 * play[0]
    slider = x if np.isnan(play[1]) else play[1]
    play[1] = min(max(slider, x - half), x + half)
    return float(x - play[1])


@compiled
def _efforts(
    time: float, qpos: FloatArray, qvel: FloatArray, ctrl: FloatArray, smooth: FloatArray,
    codes: IntArray, knots: FloatArray, values: FloatArray, plays: FloatArray, own: FloatArray,
) -> None:  # fmt: skip
    """Efforts (nv,) of all laws; `smooth` is what else pushes, for contacts."""
    own[:] = 0.0
    for law in range(len(codes)):
        code = codes[law]
        dof, base = code[DOF], code[FIRST_VALUE]
        x = _within(plays[law], _variable(code, 0, time, qpos, qvel, ctrl))
        if code[SHAPE] == STOP:
            side = values[base + 1]
            deep = side * (x - values[base])
            if deep > 0.0:
                push = values[base + 2] * deep + side * (
                    values[base + 3] * qvel[dof] + values[base + 4] * smooth[dof]
                )
                own[dof] -= side * max(push, 0.0)
            continue
        first, count = code[KNOT], code[COUNT]
        x = min(max(x, knots[first]), knots[first + count - 1])
        i = _interval(x, knots, first, count)
        p = (x - knots[first + i]) / (knots[first + i + 1] - knots[first + i])
        if code[SHAPE] == TABLE:
            effort = (1.0 - p) * values[base + i] + p * values[base + i + 1]
            own[dof] += effort
            if code[OTHER_DOF] != NONE:
                own[code[OTHER_DOF]] += code[SIGN] * effort
            continue
        other, wide = code[KNOT + WIDTH], code[COUNT + WIDTH]
        y = _variable(code, 1, time, qpos, qvel, ctrl)
        y = min(max(y, knots[other]), knots[other + wide - 1])
        j = _interval(y, knots, other, wide)
        r = (y - knots[other + j]) / (knots[other + j + 1] - knots[other + j])
        at = base + i * wide + j
        low = (1.0 - r) * values[at] + r * values[at + 1]
        high = (1.0 - r) * values[at + wide] + r * values[at + wide + 1]
        effort = (1.0 - p) * low + p * high
        own[dof] += effort
        if code[OTHER_DOF] != NONE:
            own[code[OTHER_DOF]] += code[SIGN] * effort


def lawful_rows(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    commands: FloatArray,
    steady: FloatArray,
    steps: int,
    laws: CompiledLaws,
) -> tuple[FloatArray, FloatArray]:
    """States (n, nq + nv) and sensors (n, all) under commands (n, nu) and laws.

    Args:
        model: whose physics.
        data: in its first state.
        commands: held over a row.
        steady: further efforts (nv,), the same all along.
        steps: of the model in a row.
        laws: that act at the joints.
    """
    path = np.zeros((len(commands), model.nq + model.nv))
    sensed = np.zeros((len(commands), model.nsensordata))
    _rows(
        address_of("mj_step"), *handles(model, data), steps, float(model.opt.timestep),
        np.ascontiguousarray(commands), steady, data.qpos, data.qvel, data.ctrl,
        data.qfrc_applied, data.qfrc_smooth, data.sensordata,
        laws.codes, laws.knots, laws.values, laws.plays, np.zeros(model.nv), path, sensed,
    )  # fmt: skip
    return path, sensed


@compiled
def _rows(
    mj_step: int, model: int, data: int, steps: int, period: float,
    commands: FloatArray, steady: FloatArray, qpos: FloatArray, qvel: FloatArray,
    ctrl: FloatArray, applied: FloatArray, smooth: FloatArray, sensordata: FloatArray,
    codes: IntArray, knots: FloatArray, values: FloatArray, plays: FloatArray, own: FloatArray,
    path: FloatArray, sensed: FloatArray,
) -> None:  # fmt: skip
    width = len(qpos)
    for k in range(len(commands)):
        path[k, :width] = qpos
        path[k, width:] = qvel
        ctrl[:] = commands[k]
        for n in range(steps):
            _efforts(
                (k * steps + n) * period, qpos, qvel, ctrl, smooth - own,
                codes, knots, values, plays, own,
            )  # fmt: skip
            applied[:] = steady + own
            call_engine(mj_step, model, data)
            if n == 0:
                sensed[k] = sensordata
