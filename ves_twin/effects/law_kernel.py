"""CompiledLaws: laws as numbers, for kernels that ask for their values at every step."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from ves_twin.core.compiled import compiled
from ves_twin.core.types import FloatArray, IntArray
from ves_twin.effects.law import Law, LawShape, joints_of, parts_of

TIME, POSITION, SPEED, COMMAND = range(4)
"""Where a variable is read."""

SOURCES = {"time": TIME, "position": POSITION, "speed": SPEED, "command": COMMAND}

TABLE, MESH, STOP, PLAY, HOLD = range(5)

SHAPES = {
    LawShape.TABLE: TABLE,
    LawShape.MESH: MESH,
    LawShape.STOP: STOP,
    LawShape.PLAY: PLAY,
    LawShape.HOLD: HOLD,
}

SHAPE, DOF, OTHER_DOF, SIGN, FIRST_VALUE, SOURCE = range(6)
"""Columns of a code; then those of its variables."""

INDEX, OTHER, MINUS, KNOT, COUNT = range(SOURCE + 1, SOURCE + 6)
"""Further columns of the first variable; the second's are WIDTH further on."""

WIDTH = 6

NONE = -1
"""In place of a second joint."""

GAP, SLIDER, ASKED, HELD = range(4)
"""Columns of a memory: width of the first variable's play, where its slider is, how often a law was
asked, and how often beyond its knots."""


class CompiledLaws(NamedTuple):
    """Laws as numbers.

    Attributes:
        codes: shape, number of the place, that of a second joint and its sign, first value; then
            source, index, that of a second joint, its sign, first knot and count of each variable
            (laws, 17).
        knots, values: of all.
        memory: see GAP; what laws remember from step to step (laws, 4).
    """

    codes: IntArray
    knots: FloatArray
    values: FloatArray
    memory: FloatArray

    @staticmethod
    def of(
        laws: Sequence[Law], place: Callable[[str], int], variable: Callable[[str, str], int]
    ) -> CompiledLaws:
        """Laws of a machine whose places and variables have numbers.

        Args:
            laws: all of them.
            place: number of a joint, or of a column.
            variable: number of what ("position", "speed", "command") of which joint or actuator.
        """
        codes = np.zeros((len(laws), SOURCE + 2 * WIDTH), np.int64)
        knots: list[float] = []
        values: list[float] = []
        memory = np.tile([0.0, np.nan, 0.0, 0.0], (len(laws), 1))
        for code, law, own in zip(codes, laws, memory, strict=True):
            joints = [(place(name), sign) for name, sign in joints_of(law.place)]
            code[:SOURCE] = SHAPES[law.shape], *_both(joints), len(values)
            values += law.values
            for n, name in enumerate(law.of):
                at = SOURCE + n * WIDTH
                mine = law.knots[n] if law.knots else ()
                code[at : at + WIDTH] = *_source(name, variable), len(knots), len(mine)
                knots += mine
            own[GAP] = parts_of(law.of[0])[2] if law.of else 0.0
        return CompiledLaws(codes, np.array(knots, float), np.array(values, float), memory)


def _both(joints: Sequence[tuple[int, float]]) -> tuple[int, int, int]:
    """Number of the first, that of the second or NONE, and the second's sign."""
    (first, _), (second, sign) = joints[0], joints[1] if len(joints) > 1 else (NONE, 0.0)
    return first, second, int(sign)


def _source(name: str, variable: Callable[[str, str], int]) -> tuple[int, int, int, int]:
    """Source and index of a variable, index and sign of a second joint's."""
    what, parts, _ = parts_of(name)
    if what == "time":
        return TIME, 0, NONE, 0
    return SOURCES[what], *_both([(variable(what, joint), sign) for joint, sign in parts])


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
    code: IntArray, n: int, time: float, position: FloatArray, speed: FloatArray,
    command: FloatArray,
) -> float:  # fmt: skip
    at = n * WIDTH
    source, index, other = code[SOURCE + at], code[INDEX + at], code[OTHER + at]
    if source == POSITION:
        more = 0.0 if other == NONE else code[MINUS + at] * position[other]
        return float(position[index] + more)
    if source == SPEED:
        more = 0.0 if other == NONE else code[MINUS + at] * speed[other]
        return float(speed[index] + more)
    if source == COMMAND:
        return float(command[index])
    return time


@compiled
def _within(memory: FloatArray, x: float) -> float:
    """Where x stands in its play; the slider, which begins in the middle, is moved along."""
    if memory[GAP] <= 0.0:
        return x
    half = 0.5 * memory[GAP]
    slider = x if np.isnan(memory[SLIDER]) else memory[SLIDER]
    memory[SLIDER] = min(max(slider, x - half), x + half)
    return float(x - memory[SLIDER])


@compiled
def law_value(
    time: float, position: FloatArray, speed: FloatArray, command: FloatArray,
    laws: CompiledLaws, law: int,
) -> float:  # fmt: skip
    """Value of a table or a mesh at an instant; beyond its knots it is held.

    Args:
        time: [s].
        position: of all that variables name [m, rad].
        speed: the same [m/s, rad/s].
        command: of all actuators.
        laws: of a machine.
        law: number of the one that is asked.
    """
    code, memory = laws.codes[law], laws.memory[law]
    knots, values = laws.knots, laws.values
    base = code[FIRST_VALUE]
    x = _within(memory, _variable(code, 0, time, position, speed, command))
    first, count = code[KNOT], code[COUNT]
    memory[ASKED] += 1.0
    beyond = x < knots[first] or x > knots[first + count - 1]
    x = min(max(x, knots[first]), knots[first + count - 1])
    i = _interval(x, knots, first, count)
    p = (x - knots[first + i]) / (knots[first + i + 1] - knots[first + i])
    if code[SHAPE] == TABLE:
        memory[HELD] += 1.0 if beyond else 0.0
        return float((1.0 - p) * values[base + i] + p * values[base + i + 1])
    other, wide = code[KNOT + WIDTH], code[COUNT + WIDTH]
    y = _variable(code, 1, time, position, speed, command)
    beyond = beyond or y < knots[other] or y > knots[other + wide - 1]
    memory[HELD] += 1.0 if beyond else 0.0
    y = min(max(y, knots[other]), knots[other + wide - 1])
    j = _interval(y, knots, other, wide)
    r = (y - knots[other + j]) / (knots[other + j + 1] - knots[other + j])
    at = base + i * wide + j
    low = (1.0 - r) * values[at] + r * values[at + 1]
    high = (1.0 - r) * values[at + wide] + r * values[at + wide + 1]
    return float((1.0 - p) * low + p * high)


@compiled
def law_efforts(
    time: float, position: FloatArray, speed: FloatArray, command: FloatArray, load: FloatArray,
    laws: CompiledLaws, own: FloatArray,
) -> None:  # fmt: skip
    """Efforts of all laws of efforts, by place.

    Args:
        time: [s].
        position: of all that variables name [m, rad].
        speed: the same [m/s, rad/s].
        command: of all actuators.
        load: what else pushes at each place, for contacts.
        laws: of efforts.
        own: result, by place.
    """
    values = laws.values
    own[:] = 0.0
    for law in range(len(laws.codes)):
        code = laws.codes[law]
        dof = code[DOF]
        if code[SHAPE] == STOP:
            base = code[FIRST_VALUE]
            side = values[base + 1]
            x = _variable(code, 0, time, position, speed, command)
            deep = side * (_within(laws.memory[law], x) - values[base])
            if deep > 0.0:
                push = values[base + 2] * deep + side * (
                    values[base + 3] * speed[dof] + values[base + 4] * load[dof]
                )
                own[dof] -= side * max(push, 0.0)
            continue
        effort = law_value(time, position, speed, command, laws, law)
        own[dof] += effort
        if code[OTHER_DOF] != NONE:
            own[code[OTHER_DOF]] += code[SIGN] * effort
