"""by_shape: which of two columns is the motion and which the effort, where no name tells."""

from __future__ import annotations

from dataclasses import replace
from itertools import permutations

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.machines.mjcf.draft.log_columns import LogColumns
from ves_twin.machines.mjcf.draft.match import Match, Matches
from ves_twin.machines.mjcf.draft.motion import band_of
from ves_twin.machines.mjcf.draft.spots import Quantity, Spot
from ves_twin.machines.mjcf.motion.smoothed import smoothed

CLEAR = 0.05
"""Share of its power by which an effort must be explained better than the other way round."""

RATE = 0.98
"""Correlation with the rate of another column from which a column is its speed, and no effort: a
torque at resonance comes to 0.96."""

MOST = 4
"""Columns among which a pair is looked for; among more one fits by chance."""


def by_shape(log: LogColumns, matches: Matches, spots: tuple[Spot, ...]) -> Matches:
    """With position and effort of a machine of one joint and one motor told by their shape.

    An effort is u = m x'' + c x' + k x + f sign x' + o of the motion it causes; the other way round
    that holds worse. Nothing is matched where it does not hold clearly better. A column that is
    the rate of another is neither.
    """
    columns = [c for c in log.values if c in matches.left]
    rates = {b: a for a, b in permutations(columns, 2) if _follows(log, a, b)}
    open_ = [c for c in columns if c not in rates]
    wanted = [s for s in spots if s.quantity in (Quantity.POSITION, Quantity.EFFORT)]
    if matches.found or len(wanted) != 2 or not 2 <= len(open_) <= MOST:
        return matches
    position, effort = wanted
    shares = {pair: _explained(log, *pair) for pair in permutations(open_, 2)}
    x, u = max(shares, key=lambda pair: shares[pair])
    best, back = shares[x, u], shares[u, x]
    if best < back + CLEAR:
        return matches
    why = f"{u} is {best:.0%} an effort of the motion of {x}, {back:.0%} the other way round"
    unit = {s: log.units.get(c, "") for c, s in ((x, position), (u, effort))}
    found = tuple(
        Match(column, spot, unit[spot] or spot.unit, bool(unit[spot]), 1.0, (why,))
        for column, spot in ((x, position), (u, effort))
    )
    left = {c: why for c, why in matches.left.items() if c not in (x, u)}
    left |= {b: f"is the rate of {a}" for b, a in rates.items()}
    return replace(matches, found=found, left=left)


def _follows(log: LogColumns, x: str, v: str) -> bool:
    """Whether a column is the rate of another one."""
    corner = min(2.0 * band_of(log.values[x], log.period, 0.99), 0.4 / log.period)
    motion, y = (smoothed(log.values[c], log.period, corner) for c in (x, v))
    return float(np.corrcoef(np.gradient(motion, log.period), y)[0, 1]) > RATE


def _explained(log: LogColumns, x: str, u: str) -> float:
    """Share of a column's power that a motion of one mass, spring and damper explains."""
    corner = min(2.0 * band_of(log.values[x], log.period, 0.99), 0.4 / log.period)
    motion, y = (smoothed(log.values[c], log.period, corner) for c in (x, u))
    speed = np.gradient(motion, log.period)
    basis: list[FloatArray] = [np.gradient(speed, log.period), speed, motion]
    basis += [np.tanh(speed / (0.05 * float(np.std(speed)) or 1.0)), np.ones(len(y))]
    columns = np.stack([b / (float(np.std(b)) or 1.0) for b in basis], axis=1)
    rest = y - columns @ np.linalg.lstsq(columns, y, rcond=None)[0]
    return max(1.0 - float(np.var(rest) / np.var(y)), 0.0)
