"""delay: signals that arrive late by a time, straight between the last ticks."""

from __future__ import annotations

import numpy as np

from ves_twin.core.compiled import compiled
from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray, Record

LONGEST = 64
"""Ticks that a line remembers: 21.8 ms at the transducers' tick."""

LINE = np.dtype(
    [
        ("delay", np.float64, 6),
        ("kept", np.int64),
        ("whole", np.int64, 6),
        ("share", np.float64, 6),
    ]
)
"""delay of each column [s]; what follows from it: ticks kept, 0 for a line that is not there;
whole ticks and share of the next one."""

PARAMETERS = np.dtype([("slide", LINE), ("wrench", LINE), ("current", LINE), ("setpoint", LINE)])
"""Rod travel to the transducers, wrench to the sensor's electronics, amplifier output to the
valves, set-point to the joint servos."""

PAST = (LONGEST, 6)
"""Shape of the values of the last ticks of a line."""

STATE = np.dtype(
    [
        ("slide_past", np.float64, PAST),
        ("wrench_past", np.float64, PAST),
        ("current_past", np.float64, PAST),
        ("angle_past", np.float64, PAST),
        ("rate_past", np.float64, PAST),
        ("sent", np.float64, 6),
    ]
)
"""Values of the last ticks, the newest first; sent: amplifier output before its line."""

PASTS = {
    "slide": ("slide_past",),
    "wrench": ("wrench_past",),
    "current": ("current_past", "sent"),
    "setpoint": ("angle_past", "rate_past"),
}
"""What of STATE belongs to each line."""


def count_ticks(p: np.void, tick: float) -> None:
    """Work out whole ticks and shares of every line from its delays.

    Args:
        p: PARAMETERS with the delays.
        tick: time between two values [s].

    Raises:
        InvalidInputError: a delay longer than a line.
    """
    longest = (LONGEST - 2) * tick
    for name in PARAMETERS.names or ():
        line = p[name]
        delay = line["delay"]
        if np.max(delay) > longest:
            expected = f"at most {longest:.3g} s, {LONGEST - 2} ticks"
            raise InvalidInputError(f"delay of the {name}", float(np.max(delay)), expected)
        ticks = delay / tick
        line["whole"] = np.floor(ticks)
        line["share"] = ticks - line["whole"]
        line["kept"] = np.max(line["whole"]) + 2 if np.any(delay > 0.0) else 0


@compiled
def take_late(p: Record, past: FloatArray, now: FloatArray, late: FloatArray) -> None:
    """Take the values of a tick, and give those of `delay` before, straight between two ticks.

        late(t) = (1 - r) now(t - w h) + r now(t - (w + 1) h),  delay = (w + r) h

    Called once a tick, and only for a line with `kept` > 0: without delays it costs a branch.

    Args:
        p: LINE.
        past: last values, the newest first (LONGEST, 6).
        now: values of this tick (n,).
        late: result (n,); may be `now`.
    """
    for i in range(now.shape[0]):
        for k in range(p.kept - 1, 0, -1):
            past[k, i] = past[k - 1, i]
        past[0, i] = now[i]
        w, r = p.whole[i], p.share[i]
        late[i] = (1.0 - r) * past[w, i] + r * past[w + 1, i]
