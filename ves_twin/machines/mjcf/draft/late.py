"""words_of_lag: that all efforts of an arm come later, or earlier, than its positions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.machines.mjcf.draft.effort_fit import EffortFit

MOST = 0.3
"""Longest lag that is looked for [s]; a motion of some seconds is not like itself within it."""

TRIED = 30
"""Lags to either side."""

JOINTS = 3
"""Efforts from which on a lag is told: the play of a damper and the model error of two links pass
for a lag (0.13 to 0.30 s at four of five dampers' records, 0.26 s at one of five of two links)."""

FALLS = 1.5
"""Times by which what the model and friction leave must fall: 1.3 at most on records of three
measured arms; 2.4 and 5.1 where their torques were put off by 0.1 s, 1.3 and 1.8 for 0.05 and
0.04 s."""

WORSE = 0.25
"""Share of the efforts, those that lose most by a lag, that do not count: of a wrist that is all
friction a lag tells little, and one of seven joints forbade it (a measured arm, efforts 0.1 and
0.2 s late)."""

ROWS = 2
"""Rows that are no lag: when in its row each column is sampled is not known."""


@dataclass(frozen=True)
class Pushed:
    """One effort with what the model needs for the motion.

    Attributes:
        recorded: low-passed, at every row of the log (n,).
        need: of the model, at some rows (m,).
        speed: of the joint, at these (m,).
        free: whether any constant may stand between effort and column.
    """

    recorded: FloatArray
    need: FloatArray
    speed: FloatArray
    free: bool


def words_of_lag(efforts: Sequence[Pushed], rows: np.ndarray, period: float) -> list[str]:
    """A sentence where next to every effort fits better at one common lag; or none.

    Args:
        efforts: of the joints.
        rows: at which need and speed are told (m,).
        period: of the log's rows [s].
    """
    if len(efforts) < JOINTS:
        return []
    most = int(MOST / period)
    lags = np.unique(np.round(np.linspace(-most, most, 2 * TRIED + 1)).astype(int))
    count = len(efforts[0].recorded)
    inside = (rows >= most) & (rows + most < count)
    if not np.any(inside):
        return []

    def shares(lag: int) -> FloatArray:
        return np.array([_share(one, rows, inside, lag) for one in efforts])

    explained = {int(lag): shares(int(lag)) for lag in lags}
    counted = {lag: _by_most(explained[0], there) for lag, there in explained.items()}
    best = max(counted, key=lambda lag: float(np.mean(counted[lag][1] - counted[lag][0])))
    now, then = counted[best]
    left, rest = 1.0 - float(np.mean(now)), 1.0 - float(np.mean(then))
    if abs(best) < ROWS or abs(best) == most or np.any(then < now) or left < FALLS * rest:
        return []
    return [
        f"the efforts {'lag' if best > 0 else 'lead'} the positions by {abs(best) * period:.2g} s:"
        f" beside friction the model explains {np.mean(then):.1%} of them when that is shifted,"
        f" {np.mean(now):.1%} as logged; two clocks?"
    ]


def _by_most(now: FloatArray, then: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Shares as logged and when shifted, without the few efforts that lose most by the shift."""
    kept = np.argsort(then - now)[int(WORSE * len(now)) :]
    return now[kept], then[kept]


def _share(one: Pushed, rows: np.ndarray, inside: np.ndarray, lag: int) -> float:
    """Of an effort, so many rows later, that the model explains beside friction."""
    y = one.recorded[rows[inside] + lag]
    return EffortFit.of(y, one.need[inside], one.speed[inside], one.free).share
