"""load_fits: whether an arm's efforts fit with a load on its last body, and no column is wrong."""

from __future__ import annotations

import mujoco
import numpy as np
from scipy.optimize import least_squares

from ves_twin.core.types import FloatArray
from ves_twin.machines.mjcf.plausible.reading import Reading
from ves_twin.machines.mjcf.plausible.seen import Seen
from ves_twin.machines.mjcf.rig.places import carries

LOADED = 0.5
"""Share of a machine's mass that a load may have: the strongest arms carry as much as they weigh,
most a tenth."""

ALIKE = 1.1
"""Times what the other reading leaves, that a load may leave and be as good."""

TRIES = 12
"""Points at most, from which each of mass and place is tried once: a minute of a slow machine."""

THIN = 1000
"""Rows that are looked at meanwhile."""


def load_fits(seen: Seen, beside: FloatArray, good: float) -> bool:
    """Whether a point mass on a last body leaves as little as another reading of the columns.

    Of those efforts that the other reading is right about, and of arms alone: of a pendulum a load
    opposite turns gravity round, as if its zero were elsewhere. An arm of a plant that was fitted
    with another tool looked as if its wrist were turned.

    Args:
        seen: columns.
        beside: share that the other reading leaves of each effort (c,).
        good: share up to which it is right.
    """
    model = seen.rig.model
    heaviest, reach = LOADED * float(np.sum(model.body_mass)), _reach(model)
    ends, right = ([0.0, *[-reach] * 3], [heaviest, *[reach] * 3]), beside <= good
    for body in _last(model):

        def left(load: FloatArray, rows: int = THIN, body: int = body) -> FloatArray:
            return seen.left(Reading("", "", {}, {}, load=(body, load)), rows)[right]

        begin = np.clip(np.append(0.1 * heaviest, model.body_ipos[body]), *ends)
        found = least_squares(left, begin, bounds=ends, diff_step=0.01, max_nfev=TRIES)
        whole = left(found.x, len(seen.fed.time))
        if np.sum(whole) <= ALIKE * np.sum(beside[right]) and np.all(whole <= good):
            return True
    return False


def _last(model: mujoco.MjModel) -> list[int]:
    """Moving bodies at the ends of arms, which may carry something."""
    ends = [body for body in range(1, model.nbody) if carries(model, body)]
    return sorted({int(model.body_weldid[body]) for body in ends})


def _reach(model: mujoco.MjModel) -> float:
    """Length of the chain of bodies [m]: no load sticks out further."""
    return float(np.linalg.norm(model.body_pos[1:], axis=1).sum()) or 1.0
