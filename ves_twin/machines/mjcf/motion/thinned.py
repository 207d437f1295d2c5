"""Thinned: rows of a motion that rigid-body efforts are computed at, and all others between."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import mujoco
import numpy as np
from scipy.interpolate import make_interp_spline

from ves_twin.core.types import FloatArray, IntArray
from ves_twin.machines.mjcf.parts.rigid_efforts import Moved, inverted, is_linear
from ves_twin.machines.mjcf.rig.places import SINGLE

OVER, ORDER = 6.0, 5
"""Rows in a period of the fastest motion that is compared, and order of the spline through them: of
two links that swing by a radian up to the corner it is 5e-4 of an effort's spread off, of an arm
of seven axes at 1 kHz 4e-6 at most."""

ENDS = 2
"""Rows at either end that are continued from the others: differences of second order are one-sided
there, and a spline through one would ring."""

FOLDS = 5.0
"""Rows in a period of the low-pass's corner: what folds back to it was at four times that, where a
low-pass of fourth order, forth and back, leaves 2e-5."""

FEWEST = 200
"""Rows below which every one is computed."""


@dataclass(frozen=True)
class Thinned:
    """Every so many rows of a motion.

    A motion behind a low-pass is as smooth as that lets it be, and so are efforts without friction:
    at 1 kHz and 10 Hz fifteen rows of sixteen say nothing new.

    Attributes:
        count: rows of the motion.
        every: so many of them stand for one.
    """

    count: int
    every: int

    @staticmethod
    def of(count: int, period: float, corner: float, rate: float) -> Thinned:
        """Of rows at a period [s], low-passed at a corner and compared at a rate [Hz]."""
        needed = max(OVER * min(corner, 0.5 * rate), FOLDS * corner)
        every = max(int(1.0 / (needed * period)), 1)
        return Thinned(count, every if count >= FEWEST * every else 1)

    @cached_property
    def rows(self) -> IntArray:
        """The rows (m,)."""
        last = self.count - 1 - ENDS
        return np.unique(np.append(np.arange(ENDS, last, self.every), last))

    def inverted(self, model: mujoco.MjModel, q: FloatArray, v: FloatArray, a: FloatArray) -> Moved:
        """MuJoCo's inverse dynamics along a motion, (n, nq) and (n, nv), at all of its rows.

        Row by row where anything may be at work that is not smooth.
        """
        if self.every == 1 or not is_smooth(model, q):
            return inverted(model, q, v, a)
        few = inverted(model, q[self.rows], v[self.rows], a[self.rows])
        if few.bound or not np.all(np.isfinite(few.effort)):
            return inverted(model, q, v, a)
        return Moved(q, v, self._between(few.effort), self._between(few.sensed), few.bound)

    def _between(self, columns: FloatArray) -> FloatArray:
        """Columns (m, k) at those rows, at all of them (n, k)."""
        if not columns.shape[1]:
            return np.zeros((self.count, 0))
        spline = make_interp_spline(self.rows, columns, ORDER)
        return np.asarray(spline(np.arange(self.count)))


def is_smooth(model: mujoco.MjModel, q: FloatArray) -> bool:
    """Whether neither efforts nor sensors of a model can have a kink along a motion (n, nq).

    No contact, no limit that is reached, no equality; no spring or limit of a tendon, which may be
    slack; sensors and fluid as `is_linear` has them.
    """
    off, bit = int(model.opt.disableflags), mujoco.mjtDisableBit
    bound = not off & bit.mjDSBL_CONSTRAINT
    touches = bound and not off & bit.mjDSBL_CONTACT and model.ngeom > 1
    if touches and np.any(model.geom_contype | model.geom_conaffinity):
        return False
    if bound and not off & bit.mjDSBL_LIMIT and not _within(model, q):
        return False
    tied = bound and not off & bit.mjDSBL_EQUALITY and bool(np.any(model.eq_active0))
    return not tied and not np.any(model.tendon_stiffness) and is_linear(model)


def _within(model: mujoco.MjModel, q: FloatArray) -> bool:
    """Whether every joint stays within its limits; one whose limit is none of a coordinate: no."""
    if np.any(model.tendon_limited):
        return False
    for joint in np.flatnonzero(model.jnt_limited):
        if int(model.jnt_type[joint]) not in SINGLE:
            return False
        way, margin = q[:, model.jnt_qposadr[joint]], model.jnt_margin[joint]
        low, high = model.jnt_range[joint]
        if np.min(way) < low + margin or np.max(way) > high - margin:
            return False
    return True
