"""HiddenLaw: a function that no library has, hidden in a machine; LAW_KINDS, functions of ours."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import final

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.effects.effect import Effect
from ves_twin.effects.element import Element
from ves_twin.effects.row import Anywhere
from ves_twin.suites.spot import PENDULUM, Spot

Function = Callable[[FloatArray], FloatArray]


class Acts(StrEnum):
    """On what a hidden law depends, and where it acts: at the joint, or on what is read."""

    SPEED = "speed"
    POSITION = "position"
    COMMAND = "command"
    READING = "reading"


@dataclass(frozen=True)
class HiddenLaw:
    """A function as the generator has it: no knots, no dictionary, other code than the diagnosis.

    Attributes:
        kind: name.
        acts: on what it depends.
        place: joint, or column.
        of: variable, as a diagnosis names it.
        function: effort [N or N m], or reading, at values (n,).
    """

    kind: str
    acts: Acts
    place: str
    of: str
    function: Function


@final
@dataclass(frozen=True)
class HiddenEffort(Effect):
    """A hidden law at a joint: the generator's own loop asks for it at every step."""

    law: HiddenLaw | None = None

    kind = "hidden_law"
    anywhere = Anywhere(Element.JOINT, lambda place: place.effort)

    def __post_init__(self) -> None:
        """No size to check."""

    def resist(self, speed: FloatArray, slow: float) -> FloatArray:
        """Against motion."""
        there = self.law is not None and self.law.acts is Acts.SPEED
        return -self.law.function(speed) if there and self.law else np.zeros_like(speed)

    def holder(self) -> Callable[[float], float]:
        """Against the joint along its position."""
        law = self.law
        if law is None or law.acts is not Acts.POSITION:
            return lambda position: 0.0
        return lambda position: -float(law.function(np.array([position]))[0])


@final
@dataclass(frozen=True)
class HiddenCommand(Effect):
    """A hidden law of what a motor makes of its command."""

    law: HiddenLaw | None = None

    kind = "hidden_command_law"
    anywhere = Anywhere(Element.ACTUATOR, lambda place: place.effort)

    def __post_init__(self) -> None:
        """No size to check."""

    def edit_command(self, command: FloatArray, time: FloatArray) -> FloatArray:
        """With the law."""
        return command if self.law is None else command + self.law.function(command)


def _random(
    rng: np.random.Generator, length: float, size: float, low: float, high: float
) -> Function:
    """A smooth curve drawn by chance: a Gaussian process of a length and a size."""
    x = np.linspace(low, high, 60)
    cover = np.exp(-0.5 * np.square((x[:, None] - x) / length)) + 1e-8 * np.eye(len(x))
    y = size * np.linalg.cholesky(cover) @ rng.standard_normal(len(x))
    return lambda z: np.interp(z, x, y)


Draw = Callable[[float, np.random.Generator], Function]

LAW_KINDS: Mapping[str, tuple[Acts, str, Draw]] = {
    "random_of_speed": (Acts.SPEED, "speed", lambda a, r: _random(r, 2.0, 0.03 * a, -12.0, 12.0)),
    "random_of_position": (
        Acts.POSITION, "position", lambda a, r: _random(r, 0.4, 0.05 * a, -3, 3),
    ),
    "sinh_drag": (Acts.SPEED, "speed", lambda a, r: lambda v: -0.02 * a * np.sinh(0.5 * v)),
    "stribeck": (
        Acts.SPEED, "speed",
        lambda a, r: (
            lambda v: -0.02 * a * np.tanh(v / 0.05) * (1.0 + 1.5 * np.exp(-np.abs(v) / 0.6))
        ),
    ),
    "cogging": (
        Acts.POSITION, "position",
        lambda a, r: (lambda w: lambda q: 0.03 * a * np.sin(w * q + 1.0))(r.uniform(7.0, 25.0)),
    ),
    "cubic_spring": (Acts.POSITION, "position", lambda a, r: lambda q: -0.1 * a * q**3),
    "one_sided_spring": (
        Acts.POSITION, "position",
        lambda a, r: lambda q: -0.15 * a * np.maximum(q - 0.2, 0.0) ** 1.5,
    ),
    "saturation": (Acts.COMMAND, "command", lambda a, r: lambda u: -0.06 * a * u**3),
    "dead_zone": (
        Acts.COMMAND, "command", lambda a, r: lambda u: -np.clip(u, -0.08 * a, 0.08 * a),
    ),
    "rate_square": (Acts.READING, "speed", lambda a, r: lambda v: 0.002 * a * v**2),
    "angle_ripple": (
        Acts.READING, "position", lambda a, r: lambda q: 0.004 * a * np.sin(9.0 * q + 0.5),
    ),
}  # fmt: skip
"""Kind -> where it acts, on what it depends, and what draws it, by a factor of about 1, on a joint
whose typical sizes are 1. Half of them are in no dictionary of the diagnosis."""

FACTORS = (0.3, 3.0)
"""Smallest and largest factor, log-uniform."""

VES2_LAW_KINDS: Mapping[str, tuple[Acts, str, str, Draw]] = {
    "random_of_joint_speed": (
        Acts.SPEED, "arm.q2", "speed@arm.q2", lambda a, r: _random(r, 0.3, 4.0 * a, -2.0, 2.0),
    ),
    "sinh_drag_of_joint": (
        Acts.SPEED, "arm.q1", "speed@arm.q1", lambda a, r: lambda v: -2.0 * a * np.sinh(2.0 * v),
    ),
    "one_sided_spring_of_joint": (
        Acts.POSITION, "arm.q3", "position@arm.q3",
        lambda a, r: lambda q: -4.0 * a * np.maximum(q - 0.1, 0.0) ** 1.5,
    ),
    "random_of_joint_position": (
        Acts.POSITION, "arm.q2", "position@arm.q2",
        lambda a, r: _random(r, 0.25, 3.0 * a, -0.5, 2.5),
    ),
    "square_drag_of_rod": (
        Acts.SPEED, "leg.3", "speed@leg.3", lambda a, r: lambda v: -6e4 * a * np.abs(v) * v,
    ),
    "torque_reading": (
        Acts.READING, "arm.torque.2", "position@arm.q2",
        lambda a, r: _random(r, 0.3, 1.0 * a, -0.5, 2.5),
    ),
}  # fmt: skip
"""The same of VES II, with the variable: N m at joints of the arm, N at a rod, N m of a reading.
Only the rod's is in the dictionary of the diagnosis."""


def draw_law(kind: str, rng: np.random.Generator, spots: Sequence[Spot] = (PENDULUM,)) -> HiddenLaw:
    """A law of a kind, at a random size and one of the joints that take it.

    Raises:
        InvalidInputError: no joint takes it.
    """
    low, high = np.log(FACTORS)
    factor = float(np.exp(rng.uniform(low, high)))
    if kind in VES2_LAW_KINDS:
        acts, place, of, draw = VES2_LAW_KINDS[kind]
        return HiddenLaw(kind, acts, place, of, draw(factor, rng))
    acts, of, draw = LAW_KINDS[kind]
    taking = [spot for spot in spots if takes(spot, kind)]
    if not taking:
        joints = ", ".join(spot.joint for spot in spots)
        raise InvalidInputError(f"hidden law {kind}", f"joints {joints}", "one that it can act at")
    shape = draw(factor, rng)
    spot = taking[int(rng.integers(len(taking)))]
    unit = {"speed": spot.speed, "position": spot.travel, "command": spot.effort}[of]
    at = spot.actuator if acts is Acts.COMMAND else spot.joint
    place, size = spot.columns[of] if acts is Acts.READING else (spot.joint, spot.effort)
    return HiddenLaw(kind, acts, place, f"{of}@{at}", lambda x: size * shape(x / unit))


def takes(spot: Spot, kind: str) -> bool:
    """Whether a kind can be hidden at a joint."""
    acts, of, _ = LAW_KINDS[kind]
    if acts is Acts.READING:
        return of in spot.columns
    return acts is not Acts.COMMAND or bool(spot.actuator)
