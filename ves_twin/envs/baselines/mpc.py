"""Mpc: model predictive control on the environment's own linear model, bounds and all."""

from __future__ import annotations

from typing import final

import numpy as np
from scipy.optimize import lsq_linear

from ves_twin.core.types import FloatArray
from ves_twin.envs.baselines.lqg import Lqg
from ves_twin.envs.policy import TaskSpec

HORIZON = 12
"""Steps looked ahead: 0.6 s, half a swing of the base; the rest is the value without bounds."""


@final
class Mpc(Lqg):
    """Least quadratic cost over HORIZON steps with every action within its bounds, again each step.

        min  sum x_k' Q x_k + u_k' R u_k + x_N' P x_N,   x_k+1 = A x_k + B u_k,  -1 <= u_k <= 1

    with the weights, the estimator and the value P of `Lqg`, whose action it is wherever no bound
    is met. Condensed, U = (u_0, ..., u_N-1): U' H U / 2 + x_0' F' U, a bounded least squares.

    Source: Rawlings, Mayne, Diehl, Model Predictive Control, 2nd ed. 2017, chapter 1 and 2.
    """

    def __init__(self, briefing: TaskSpec) -> None:
        super().__init__(briefing)
        weight, effort, value = self._weights
        n, m = self._b.shape
        reach, push = np.eye(n), np.zeros((n, m * HORIZON))
        hessian = np.kron(np.eye(HORIZON), effort)
        slope = np.zeros((m * HORIZON, n))
        for k in range(HORIZON):
            push = self._a @ push
            push[:, m * k : m * (k + 1)] = self._b
            reach = self._a @ reach
            cost = value if k == HORIZON - 1 else weight
            hessian += push.T @ cost @ push
            slope += push.T @ cost @ reach
        self._root = np.linalg.cholesky((hessian + hessian.T) / 2.0).T
        self._slope = np.linalg.solve(self._root.T, slope)
        self._width = m

    def decide(self, state: FloatArray) -> FloatArray:
        """The first of the best actions."""
        wanted = -self._slope @ state
        free = np.linalg.solve(self._root, wanted)
        if np.max(np.abs(free)) > 1.0:
            free = lsq_linear(self._root, wanted, (-1.0, 1.0), method="bvls").x
        return np.asarray(np.clip(free[: self._width], -1.0, 1.0))
