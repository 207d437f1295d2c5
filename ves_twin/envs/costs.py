"""Costs: how near a rig is to its limits of stroke, wrench and stability, cycle by cycle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ves_twin.core.compiled import compiled
from ves_twin.core.types import Block, FloatArray

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
        self._filter = np.zeros((4, 3))
        self._filter[0] = force
        self.used = np.zeros(3)

    def update(self, samples: Block) -> None:
        """Take the readings of cycles: SAMPLE of `ves_twin.simulator.cycles` (k,)."""
        limits = self._limits
        _update(
            self.used, self._filter, samples, limits.home_lengths, limits.travel,
            limits.wrench, self._keep, self._fade,
        )  # fmt: skip

    def costs(self) -> dict[str, float]:
        """Cost by name: 0 up to FREE_SHARE of a limit, 1 at the limit."""
        return {
            name: max(used - FREE_SHARE, 0.0) / (1.0 - FREE_SHARE)
            for name, used in zip(self.NAMES, self.used.tolist(), strict=True)
        }


@compiled
def _update(
    used: FloatArray,
    state: FloatArray,
    samples: Block,
    home_lengths: FloatArray,
    travel: float,
    limit: FloatArray,
    keep: float,
    fade: float,
) -> None:
    """Rows of the state: last force, both sections of the high-pass, mean square of the last."""
    for n in range(len(samples)):
        leg_length, wrench = samples[n].leg_length, samples[n].wrench
        used[0] = used[1] = 0.0
        for i in range(6):
            used[0] = max(used[0], abs(leg_length[i] - home_lengths[i]) / travel)
            used[1] = max(used[1], abs(wrench[i]) / limit[i])
        power = 0.0
        for k in range(3):
            first = keep * (state[1, k] + wrench[k] - state[0, k])
            state[2, k] = keep * (state[2, k] + first - state[1, k])
            state[0, k], state[1, k] = wrench[k], first
            power += state[2, k] ** 2
        state[3, 0] = fade * state[3, 0] + (1.0 - fade) * power
    used[2] = np.sqrt(state[3, 0]) / VIBRATION_LIMIT
