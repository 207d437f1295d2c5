"""Resistance: an effort against a joint's motion, as a form and its numbers, for compiled loops."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import IntEnum
from typing import final

import numpy as np

from ves_twin.core.compiled import compiled
from ves_twin.core.types import FloatArray

NUMBERS = 4
"""Most that a form has."""

BEGUN, STATE = range(2)
"""Columns of a memory: where a joint was at the last step, NaN before the first, and the slider's
place or the share of the level there."""


@final
class Form(IntEnum):
    """What an effort against a joint depends on: speed v, place q, what was before, the load L.

    Numbers a, b, c, d in their order; `slow` is a speed over which a sign is smoothed.
    """

    NONE = 0
    STEADY = 1
    """a"""
    BY_SIZE = 2
    """a |v|"""
    BY_SQUARE = 3
    """a v |v|"""
    BY_SIDE = 4
    """a tanh(v / slow)^2"""
    SMOOTHED = 5
    """a tanh(v / max(b, slow))"""
    FALLING = 6
    """a exp(-(v / b)^2) tanh(v / slow); nothing where b is none."""
    WAVES = 7
    """a cos(c q) + b sin(c q)"""
    SLIDER = 8
    """Level a, difference b, travel c, gap d of a Jenkins element."""
    CREEPING = 9
    """Level a, travel b of Dahl's element."""
    BY_LOAD = 10
    """a |L| tanh(v / slow)"""


@final
@dataclass(frozen=True)
class Resistance:
    """Effort [N, N m] against a joint's motion.

    Attributes:
        form: what it depends on.
        numbers: of the form, at most four.
    """

    form: Form = Form.NONE
    numbers: tuple[float, ...] = ()

    @property
    def row(self) -> FloatArray:
        """The numbers, filled up with zeros (4,)."""
        return np.array([*self.numbers, *[0.0] * (NUMBERS - len(self.numbers))])

    def by_speed(self, speed: FloatArray, slow: float) -> FloatArray:
        """The part that speeds (n,) tell."""
        if not Form.STEADY <= self.form <= Form.FALLING:
            return np.zeros_like(speed)
        return _along_speed(int(self.form), self.row, np.asarray(speed, float), slow)

    def by_place(self, position: FloatArray) -> FloatArray:
        """The part that positions (n,) tell, of a motion that begins unloaded."""
        if not Form.WAVES <= self.form <= Form.CREEPING:
            return np.zeros_like(position)
        return _along_place(int(self.form), self.row, np.asarray(position, float))

    def by_load(self, load: FloatArray, speed: FloatArray, slow: float) -> FloatArray:
        """The part that loads (n,) and speeds tell."""
        if self.form is not Form.BY_LOAD:
            return np.zeros_like(load)
        return np.asarray(self.numbers[0] * np.abs(load) * np.tanh(speed / slow))


@compiled
def of_speed(form: int, numbers: FloatArray, speed: float, slow: float) -> float:
    """Effort of a form that speed tells; 0 of another one."""
    a, b = numbers[0], numbers[1]
    if form == Form.STEADY:
        return float(a)
    if form == Form.BY_SIZE:
        return float(a * abs(speed))
    if form == Form.BY_SQUARE:
        return float(a * speed * abs(speed))
    if form == Form.BY_SIDE:
        return float(a * math.tanh(speed / slow) ** 2)
    if form == Form.SMOOTHED:
        return float(a * math.tanh(speed / max(b, slow)))
    if form == Form.FALLING and b > 0.0:
        return float(a * math.exp(-((speed / b) ** 2)) * math.tanh(speed / slow))
    return 0.0


@compiled
def of_place(form: int, numbers: FloatArray, position: float, memory: FloatArray) -> float:
    """Effort of a form that place and past tell; 0 of another one. The memory (2,) is moved on."""
    a, b, c = numbers[0], numbers[1], numbers[2]
    if form == Form.WAVES:
        return float(a * math.cos(c * position) + b * math.sin(c * position))
    if form == Form.SLIDER:
        slider = position if np.isnan(memory[BEGUN]) else memory[STATE]
        share, memory[STATE] = _slip(position, slider, b, c, numbers[3])
        memory[BEGUN] = position
        return float(a * share)
    if form == Form.CREEPING:
        begun = memory[BEGUN]
        share = 0.0 if np.isnan(begun) else _crept(memory[STATE], begun, position, b)
        memory[BEGUN], memory[STATE] = position, share
        return float(a * share)
    return 0.0


@compiled
def of_load(numbers: FloatArray, load: float, speed: float, slow: float) -> float:
    """Effort of `BY_LOAD`."""
    return float(numbers[0] * abs(load) * math.tanh(speed / slow))


@compiled
def _slip(
    position: float, slider: float, difference: float, travel: float, gap: float
) -> tuple[float, float]:
    """Share of the level of a Jenkins element, and where its slider is then."""
    apart = position - slider
    half = 0.5 * gap
    strain = apart - half if apart > half else (apart + half if apart < -half else 0.0)
    share = strain / travel
    forward, back = 1.0 + difference, -(1.0 - difference)
    if share > forward:
        return forward, slider + (share - forward) * travel
    if share < back:
        return back, slider + (share - back) * travel
    return share, slider


@compiled
def _crept(share: float, start: float, end: float, travel: float) -> float:
    """Share of the level of a Dahl element behind a move that it began with another share."""
    side = 1.0 if end > start else -1.0
    return side - (side - share) * math.exp(-abs(end - start) / travel)


@compiled
def _along_speed(form: int, numbers: FloatArray, speed: FloatArray, slow: float) -> FloatArray:
    efforts = np.empty_like(speed)
    for k in range(len(speed)):
        efforts[k] = of_speed(form, numbers, speed[k], slow)
    return efforts


@compiled
def _along_place(form: int, numbers: FloatArray, position: FloatArray) -> FloatArray:
    efforts, memory = np.empty_like(position), np.full(2, np.nan)
    for k in range(len(position)):
        efforts[k] = of_place(form, numbers, position[k], memory)
    return efforts
