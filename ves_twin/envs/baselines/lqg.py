"""Lqg: linear quadratic control with a Kalman filter on the environment's own linear model."""

from __future__ import annotations

import numpy as np
from scipy.linalg import solve_discrete_are

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.envs.policy import Policy, TaskSpec

EFFORT = 0.1
"""Loss of a share of 1 over a second [J]; tuned on train-v0."""

RETURN = 0.5
"""Loss of a set-point one radian from its start over a second [J]; keeps the arm where it was."""

PUSH = 5.0
"""Unknown force and moment on the base over a step [N, N m], for the filter."""

READING = np.array([1e-5] * 6 + [2e-4] * 6)
"""Noise that the filter expects: pose [m, rad], joints and set-points [rad]; counts included."""


class Lqg(Policy):
    """Minimises strain energy plus effort; sees pose, joints and set-points.

    The model takes the step's action as held for the step; that rates go linearly, and the arm's
    two cycles of look-ahead, count as one step of delay.

    Args:
        briefing: of an environment of the arm on an elastic base.
        effort: loss of a share of 1 over a second [J].

    Raises:
        InvalidInputError: another environment.
    """

    def __init__(self, briefing: TaskSpec, effort: float = EFFORT) -> None:
        from control import sample_system  # slow to import

        arm = "arm.rate" in briefing.actions.slices
        if not (arm and briefing.emulated and np.any(briefing.emulated.stiffness)):
            raise InvalidInputError("Lqg", "no elastic base", "VesTwin/VibrationDamping-v0")
        self._known = briefing
        prior = briefing.prior()
        held = sample_system(prior, briefing.step, method="zoh")
        n, m = held.B.shape
        # the last action is a state: it acts from the next step on
        a = np.block([[held.A, held.B], [np.zeros((m, n + m))]])
        b = np.vstack([np.zeros((n, m)), np.eye(m)])
        c = np.hstack([held.C, np.zeros((len(held.C), m))])
        weight = np.zeros((n + m, n + m))
        weight[12:18, 12:18] = (briefing.emulated.stiffness + briefing.emulated.stiffness.T) / 4
        weight[30:33, 30:33] = RETURN * np.eye(3)
        price = effort * np.eye(m)
        value = solve_discrete_are(a, b, weight, price)
        self._weights = weight, price, value
        self._gain = np.linalg.solve(price + b.T @ value @ b, b.T @ value @ a)
        pushes = np.zeros((n + m, 6))
        pushes[6:12] = np.linalg.inv(briefing.emulated.mass) * briefing.step * PUSH
        drive = pushes @ pushes.T + 1e-12 * np.eye(n + m)
        noise = np.diag(READING**2)
        spread = solve_discrete_are(a.T, c.T, drive, noise)
        self._correction = spread @ c.T @ np.linalg.inv(c @ spread @ c.T + noise)
        self._a, self._b, self._c = a, b, c

    def begin(self, observation: FloatArray) -> None:
        """At rest at the first pose."""
        seen = self._known.observations.split(observation)
        self._start = np.concatenate([np.zeros(6), seen["arm.q"], seen["arm.command"]])
        self._state = np.zeros(len(self._a))
        self._state[:6] = self._state[12:18] = seen["platform.pose"]

    def act(self, observation: FloatArray) -> FloatArray:
        """Correct the estimate by the readings, then act on it."""
        action = self.decide(self.estimate(observation))
        self.expect(action)
        return action

    def estimate(self, observation: FloatArray) -> FloatArray:
        """The state (n,), corrected by the readings of now."""
        seen = self._known.observations.split(observation)
        reading = np.concatenate([seen["platform.pose"], seen["arm.q"], seen["arm.command"]])
        off = reading - self._start - self._c @ self._state
        self._state = self._state + self._correction @ off
        return self._state

    def expect(self, action: FloatArray) -> None:
        """Carry the estimate on to the next step under an action."""
        self._state = self._a @ self._state + self._b @ action

    def decide(self, state: FloatArray) -> FloatArray:
        """The action for an estimated state: the optimal one without bounds, cut off at them."""
        return np.asarray(np.clip(-self._gain @ state, -1.0, 1.0))
