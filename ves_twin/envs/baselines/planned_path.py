"""PlannedPath: set-points that minimise the predicted loss on the believed base, open loop."""

from __future__ import annotations

from typing import final

import numpy as np
from scipy.interpolate import BSpline
from scipy.optimize import minimize

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.envs.baselines.path_policy import DURATION, PathPolicy, timed
from ves_twin.envs.reach import ENERGY
from ves_twin.mechanics.planning.base_motion import base_motion
from ves_twin.mechanics.planning.flexible_base import strain_energy
from ves_twin.plant.puma_chain import puma_chain

KNOTS = 10
"""Free points of each joint's cubic spline."""

MOVING = 6.0
"""Time in which the plan may move [s]; after it the arm rests at the goal."""

EVALUATIONS = 40
"""Iterations of the search; the loss has fallen by all but per cent before."""

DIFFERENCE = 1e-4
"""Step of the difference quotients [rad]."""

SHARPNESS = 0.02
"""Rounds the tip of the distance, so that it has a slope at the goal [rad]."""


@final
class PlannedPath(PathPolicy):
    """Splines from rest at the start to rest at the goal, by L-BFGS on `base_motion`.

    The prediction is the linear base under joints that follow exactly, with the environment's own
    loss: strain energy over 0.1 J plus distance to the goal.
    """

    def plan(self, start: FloatArray, goal: FloatArray) -> FloatArray:
        """Joint angles by step [rad] (n, 3)."""
        known = self._briefing
        if known.emulated is None:
            raise InvalidInputError("PlannedPath", "no emulated base", "one to plan on")
        chain, base, h = puma_chain(known.belief), known.emulated, known.step
        count = int(np.ceil(known.duration / h)) + 2
        basis = _basis(np.clip(np.arange(count) * h / MOVING, 0.0, 1.0))

        def paths(points: FloatArray) -> FloatArray:
            shares = points.reshape(-1, KNOTS, 3)
            ends = [np.broadcast_to(end, (len(shares), 3, 3)) for end in (start, goal)]
            return np.asarray(basis @ np.concatenate([ends[0], shares, ends[1]], axis=1))

        def losses(points: FloatArray) -> FloatArray:
            q = paths(points)
            energy = strain_energy(base, base_motion(chain, base, q, h))
            away = np.sqrt(np.sum((q - goal) ** 2, axis=-1) + SHARPNESS**2)
            return np.asarray(h * np.sum(energy / ENERGY + away, axis=-1))

        def loss_and_slope(points: FloatArray) -> tuple[float, FloatArray]:
            around = points + DIFFERENCE * np.vstack([np.zeros(len(points)), np.eye(len(points))])
            found = losses(around)
            return float(found[0]), (found[1:] - found[0]) / DIFFERENCE

        first = timed(np.array([start, goal]), DURATION, MOVING / (KNOTS + 1), MOVING)
        guess = first[1 : KNOTS + 1].ravel()
        best = minimize(
            loss_and_slope, guess, jac=True, method="L-BFGS-B", options={"maxiter": EVALUATIONS}
        )
        return np.asarray(paths(best.x)[0])


def _basis(shares: FloatArray) -> FloatArray:
    """Values of the KNOTS + 6 cubic B-splines at shares of the moving time (n, KNOTS + 6).

    The first and last three points are equal, so that the curve begins and ends at rest.
    """
    inner = np.linspace(0.0, 1.0, KNOTS + 4)
    knots = np.concatenate([np.zeros(3), inner, np.ones(3)])
    return np.asarray(BSpline.design_matrix(shares, knots, 3).toarray())
