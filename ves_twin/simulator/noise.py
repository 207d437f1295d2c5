"""NoiseStreams: standard normal numbers per channel, indexed by tick.

Tick k of a channel is the same number whatever the sub-step, the fidelity or the order of calls,
so runs that differ in one thing see the same noise, and a snapshot needs nothing but the tick.
"""

from __future__ import annotations

import numpy as np

from ves_twin.simulator.codes import FAST_CHANNELS, SLOW, SLOW_CHANNELS
from ves_twin.types import SingleArray

BLOCK = 4096
"""Ticks drawn at once; a block is a function of seed, channel and block number alone."""

ORIGIN = 1 << 40
"""Ticks count from here, so that the settling before t = 0 has numbers of its own."""


class NoiseStreams:
    """One stream per channel, by Philox counters: key = (seed, channel), counter = block.

    Single precision: twice as fast to draw, and noise needs no more digits.
    """

    def __init__(self, seed: int, enabled: bool = True) -> None:
        self._seed = seed
        self._enabled = enabled
        self._block = -1
        self._fast = np.zeros((2 * BLOCK, FAST_CHANNELS), np.float32)
        self._slow = np.zeros((2 * BLOCK // SLOW, SLOW_CHANNELS), np.float32)

    def window(self, tick: int, count: int) -> tuple[SingleArray, SingleArray]:
        """Numbers of ticks tick ... tick + count - 1, count at most BLOCK.

        Args:
            tick: first tick, negative before the start of the run.
            count: how many.

        Returns:
            Standard normal numbers of the fast channels (count, FAST_CHANNELS), and from the
            slow row that holds the first tick on (rows, SLOW_CHANNELS); zeros if noise is off.
        """
        if not self._enabled:
            return self._fast[:count], self._slow
        block, offset = divmod(tick + ORIGIN, BLOCK)
        if block != self._block:
            self._fill(block)
        return self._fast[offset : offset + count], self._slow[offset // SLOW :]

    def _fill(self, block: int) -> None:
        half = BLOCK // SLOW
        if block == self._block + 1:
            self._fast[:BLOCK], self._slow[:half] = self._fast[BLOCK:], self._slow[half:]
        else:
            self._draw(block, self._fast[:BLOCK], self._slow[:half])
        self._draw(block + 1, self._fast[BLOCK:], self._slow[half:])
        self._block = block

    def _draw(self, block: int, fast: SingleArray, slow: SingleArray) -> None:
        for channel in range(FAST_CHANNELS + SLOW_CHANNELS):
            bits = np.random.Philox(key=[self._seed, channel], counter=[0, block, 0, 0])
            numbers = np.random.Generator(bits)
            if channel < FAST_CHANNELS:
                fast[:, channel] = numbers.standard_normal(BLOCK, np.float32)
            else:
                column = channel - FAST_CHANNELS
                slow[:, column] = numbers.standard_normal(BLOCK // SLOW, np.float32)
