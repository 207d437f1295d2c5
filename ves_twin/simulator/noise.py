"""NoiseStreams: standard normal numbers per channel, indexed by tick.

Tick k of a channel is the same number whatever the sub-step, the fidelity or the order of calls,
so runs that differ in one thing see the same noise, and a snapshot needs nothing but the tick.
"""

from __future__ import annotations

import numpy as np

from ves_twin.types import FloatArray

BLOCK = 4096
"""Ticks drawn at once; a block is a function of seed, channel and block number alone."""

LENGTH, WHITE, WANDER, ENCODER, TORQUE, PRESSURE = 0, 6, 12, 18, 21, 24
"""First channel of each group."""
CHANNELS = 25

ORIGIN = 1 << 40
"""Ticks count from here, so that the settling before t = 0 has numbers of its own."""


class NoiseStreams:
    """One stream per channel, by Philox counters: key = (seed, channel), counter = block."""

    def __init__(self, seed: int, enabled: bool = True) -> None:
        self._seed = seed
        self._enabled = enabled
        self._block = -1
        self._numbers = np.zeros((2 * BLOCK, CHANNELS))

    def window(self, tick: int, count: int) -> FloatArray:
        """Numbers of ticks tick ... tick + count - 1, count at most BLOCK.

        Args:
            tick: first tick, negative before the start of the run.
            count: how many.

        Returns:
            Standard normal numbers (count, CHANNELS); zeros if noise is off.
        """
        if not self._enabled:
            return self._numbers[:count]
        first = tick + ORIGIN
        block, offset = divmod(first, BLOCK)
        if block != self._block:
            self._fill(block)
        return self._numbers[offset : offset + count]

    def _fill(self, block: int) -> None:
        follows = block == self._block + 1 and self._block >= 0
        if follows:
            self._numbers[:BLOCK] = self._numbers[BLOCK:]
        else:
            self._draw(block, self._numbers[:BLOCK])
        self._draw(block + 1, self._numbers[BLOCK:])
        self._block = block

    def _draw(self, block: int, target: FloatArray) -> None:
        for channel in range(CHANNELS):
            bits = np.random.Philox(key=[self._seed, channel], counter=[0, block, 0, 0])
            target[:, channel] = np.random.Generator(bits).standard_normal(BLOCK)
