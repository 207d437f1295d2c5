"""codes: numbers that the compiled loop shares with Python.

They live apart so that a change enters the hash of `ves_twin.core.compiled` and is compiled afresh.
"""

from __future__ import annotations

RUNNING, NOT_FINITE, LEG_AT_LIMIT, WRENCH_OUT_OF_RANGE = 0, 1, 2, 3
"""How a stretch of the compiled loop ended."""

HUGE = 1e3
"""Position [m, rad] beyond which a state counts as not finite."""

LENGTH, WHITE, FAST_CHANNELS = 0, 6, 12
"""First noise channel of each group with a number every tick, and how many there are."""

WANDER, TORQUE, PRESSURE, SLOW_CHANNELS = 0, 6, 9, 10
"""The same for the groups with a number every SLOW ticks."""

SLOW = 16
"""Ticks between two numbers of a slow channel: 5.5 ms."""
