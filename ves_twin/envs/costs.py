"""Costs: how near a rig is to its limits of stroke, wrench and stability, cycle by cycle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ves_twin.types import FloatArray

FREE_SHARE = 0.9
"""Share of a limit that costs nothing; from there the cost grows linearly to 1 at the limit."""

VIBRATION_LIMIT = 50.0
"""Force above VIBRATION_CORNER at which the loop counts as unstable [N rms]; assumed: a standing
rig has below 1 N, the limit cycle of docs/limits.md 450 N peak."""

VIBRATION_CORNER = 5.0
"""Corner of two high-pass sections in a row [Hz]; the loop's limits are at 7 to 18 Hz."""

VIBRATION_MEMORY = 0.5
"""Time over which the square of the force is averaged [s]."""


@dataclass(frozen=True)
class Limits:
    """What must not be passed.

    Attributes:
        home_lengths: leg lengths at home [m] (6,).
        travel: travel from home that commands may use [m].
        wrench: range of the force sensor [N, N m] (6,).
    """

    home_lengths: FloatArray
    travel: float
    wrench: FloatArray


class Costs:
    """Share of each limit in use, by name, from readings alone.

    Attributes:
        used: stroke, wrench and stability, 1 at the limit (3,).
    """

    NAMES = ("stroke", "wrench", "stability")

    def __init__(self, limits: Limits, period: float) -> None:
        self._limits = limits
        self._keep = 1.0 / (1.0 + 2.0 * np.pi * VIBRATION_CORNER * period)
        self._fade = float(np.exp(-period / VIBRATION_MEMORY))
        self.begin(np.zeros(3))

    @property
    def home_lengths(self) -> FloatArray:
        """Leg lengths at home [m] (6,)."""
        return self._limits.home_lengths

    def begin(self, force: FloatArray) -> None:
        """Start at rest under a force [N] (3,)."""
        self._force, self._first, self._second = force.copy(), np.zeros(3), np.zeros(3)
        self._square = 0.0
        self.used = np.zeros(3)

    def update(self, leg_length: FloatArray, wrench: FloatArray) -> None:
        """Take the readings of a cycle: leg lengths [m] (6,), wrench in sensor axes (6,)."""
        force = wrench[:3]
        first = self._keep * (self._first + force - self._force)
        self._second = self._keep * (self._second + first - self._first)
        self._force, self._first = force.copy(), first
        power = float(self._second @ self._second)
        self._square = self._fade * self._square + (1.0 - self._fade) * power
        away = np.abs(leg_length - self._limits.home_lengths)
        self.used[0] = away.max() / self._limits.travel
        self.used[1] = (np.abs(wrench) / self._limits.wrench).max()
        self.used[2] = np.sqrt(self._square) / VIBRATION_LIMIT

    def costs(self) -> dict[str, float]:
        """Cost by name: 0 up to FREE_SHARE of a limit, 1 at the limit."""
        beyond = np.maximum(self.used - FREE_SHARE, 0.0) / (1.0 - FREE_SHARE)
        return {name: float(cost) for name, cost in zip(self.NAMES, beyond, strict=True)}
