"""NoiseStreams: standard normal numbers per channel, indexed by tick.

Tick k of a channel is the same number whatever the sub-step, the fidelity or the order of calls,
so runs that differ in one thing see the same noise, and a snapshot needs nothing but the tick.
"""

from __future__ import annotations

from dataclasses import dataclass
from threading import Thread

import numpy as np

from ves_twin.core.types import SingleArray
from ves_twin.simulator.codes import FAST_CHANNELS, SLOW, SLOW_CHANNELS

BLOCK = 4096
"""Ticks drawn at once; a block is a function of seed, channel and block number alone."""

ORIGIN = 1 << 40
"""Ticks count from here, so that the settling before t = 0 has numbers of its own."""


class NoiseStreams:
    """One stream per channel, by Philox counters: key = (seed, channel), counter = block.

    Single precision: noise needs no more digits. While one block is used the next one is drawn
    in a thread, which takes a hundredth off a run where a second core is free.
    """

    def __init__(self, seed: int, enabled: bool = True) -> None:
        self._seed = seed
        self._enabled = enabled
        self._block = -1
        self._fast = np.zeros((2 * BLOCK, FAST_CHANNELS), np.float32)
        self._slow = np.zeros((2 * BLOCK // SLOW, SLOW_CHANNELS), np.float32)
        self._ahead: _Ahead | None = None

    def window(self, tick: int, count: int) -> tuple[SingleArray, SingleArray]:
        """Numbers of ticks tick ... tick + count - 1, count at most BLOCK.

        Args:
            tick: first tick, negative before the start of the run.
            count: how many.

        Returns:
            Standard normal numbers of the fast channels (count, FAST_CHANNELS), and of the slow
            ones from the number that holds at the first tick on (n, SLOW_CHANNELS); zeros if
            noise is off. A tick's numbers lie side by side.
        """
        if not self._enabled:
            return self._fast[:count], self._slow
        block, offset = divmod(tick + ORIGIN, BLOCK)
        if block != self._block:
            self._fill(block)
        return self._fast[offset : offset + count], self._slow[offset // SLOW :]

    def _fill(self, block: int) -> None:
        """Have this block and the next one in the arrays, and the one after them under way."""
        half = BLOCK // SLOW
        if block == self._block + 1 and self._ahead is not None:
            self._fast[:BLOCK] = self._fast[BLOCK:]
            self._slow[:half] = self._slow[half:]
            following = self._ahead.result()
        else:
            first = _draw(self._seed, block)
            self._fast[:BLOCK], self._slow[:half] = first.fast, first.slow
            following = _draw(self._seed, block + 1)
        self._fast[BLOCK:], self._slow[half:] = following.fast, following.slow
        self._ahead = _Ahead(self._seed, block + 2)
        self._ahead.start()
        self._block = block


@dataclass(frozen=True)
class _Drawn:
    """One block of all channels, a row a number of each."""

    fast: SingleArray
    slow: SingleArray


class _Ahead(Thread):
    """A block that is drawn in a thread of its own."""

    def __init__(self, seed: int, block: int) -> None:
        super().__init__(name="noise")
        self._seed, self._block = seed, block
        self._drawn: _Drawn | None = None

    def run(self) -> None:
        self._drawn = _draw(self._seed, self._block)

    def result(self) -> _Drawn:
        """The block; drawn here in a process that was forked meanwhile: no thread goes with it."""
        self.join()
        return self._drawn or _draw(self._seed, self._block)


def _draw(seed: int, block: int) -> _Drawn:
    fast = np.empty((FAST_CHANNELS, BLOCK), np.float32)
    slow = np.empty((SLOW_CHANNELS, BLOCK // SLOW), np.float32)
    bits = np.random.Philox(key=[seed, 0], counter=[0, block, 0, 0])
    normal, start = np.random.Generator(bits), bits.state  # a new one for each takes a fifth more
    for channel, row in enumerate([*fast, *slow]):
        start["state"]["key"][1] = channel
        bits.state = start
        normal.standard_normal(dtype=np.float32, out=row)
    return _Drawn(fast.T, slow.T)
