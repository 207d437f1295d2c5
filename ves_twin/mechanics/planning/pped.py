"""search_gains: joint gains that damp an arm's flexible base best, by one of two measures."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm, solve_continuous_lyapunov
from scipy.optimize import minimize

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import ComplexArray, FloatArray
from ves_twin.mechanics.planning.flexible_base import FlexibleBaseArm, JointGains

Build = Callable[[JointGains], FlexibleBaseArm]
"""The arm on its base with these joint gains."""

Measure = Callable[[FlexibleBaseArm], float]
"""What is made small; infinite where it makes no sense."""

EVALUATIONS = 4000
"""Of the measure for each start; a search that uses them all says so."""


def damping_estimator(poles: ComplexArray) -> float:
    """Sum over the poles of zeta_i (1 - w_i / sum w), with zeta = 1 for a real pole.

    Source: thesis eq. 4.4. It rewards real poles wherever they are: a joint left without spring
    has its poles near zero and counts as perfectly damped (errata E-37).
    """
    frequency = np.abs(poles)
    ratio = np.divide(-poles.real, frequency, out=np.zeros_like(frequency), where=frequency > 0)
    return float(np.sum(ratio * (1.0 - frequency / np.sum(frequency))))


def strain_energy_integral(arm: FlexibleBaseArm, start: FloatArray, until: float = np.inf) -> float:
    """Integral of the base's strain energy after a release at rest from a pose, exactly.

    With (x, x')' = A (x, x') and E = x' C x the integral to infinity is x0' P x0,
    A' P + P A + C = 0; to a time T it is x0' (P - Phi' P Phi) x0, Phi = expm(A T).

    Args:
        arm: the arm on its base.
        start: Y(0) [m, rad] (6,).
        until: T [s].

    Returns:
        The integral [J s]; infinite where the motion does not die out.
    """
    a = arm.state_matrix
    energy = np.zeros_like(a)
    energy[:6, :6] = 0.5 * arm.stiffness[:6, :6]
    state = np.zeros(len(a))
    state[:6] = start
    return quadratic_integral(a, energy, state, until)


def quadratic_integral(a: FloatArray, form: FloatArray, state: FloatArray, until: float) -> float:
    """Integral of x' C x from zero to a time, x' = A x from x0, exactly; inf where A is unstable.

    Args:
        a: A (n, n).
        form: C (n, n).
        state: x0 (n,).
        until: end [s]; may be infinite.
    """
    if np.max(np.linalg.eigvals(a).real) >= 0:
        return float("inf")
    total = solve_continuous_lyapunov(a.T, -form)
    end = expm(a * until) @ state if np.isfinite(until) else np.zeros_like(state)
    return float(state @ total @ state - end @ total @ end)


@dataclass(frozen=True)
class GainSearch:
    """What a search found.

    Attributes:
        gains: the best joint gains.
        value: the measure there.
        at_bounds: names of the gains that ran into a bound, such as "B2"; a measure whose optimum
            lies there does not determine them.
        converged: whether the best start ended by tolerance.
    """

    gains: JointGains
    value: float
    at_bounds: tuple[str, ...]
    converged: bool


def search_gains(
    build: Build,
    measure: Measure,
    starts: list[JointGains],
    bounds: tuple[float, float] = (0.1, 1e4),
) -> GainSearch:
    """Diagonal joint gains that make a measure smallest, from several starts (Nelder-Mead).

    The search runs over the logarithms of the gains, within bounds.

    Args:
        build: the arm on its base as a function of the gains.
        measure: for instance `lambda arm: -damping_estimator(arm.poles())`.
        starts: diagonal gains to start from.
        bounds: smallest and largest gain allowed [N m/rad, N m s/rad].

    Raises:
        InvalidInputError: no start, full matrices, or bounds that are none.
    """
    low, high = bounds
    if not 0 < low < high < np.inf:
        raise InvalidInputError("gain bounds", bounds, "0 < low < high")
    if not starts or any(g.stiffness.ndim != 1 or g.damping.ndim != 1 for g in starts):
        raise InvalidInputError("gain search starts", len(starts), "one or more diagonal gains")

    def cost(logarithms: FloatArray) -> float:
        return measure(build(_gains(logarithms)))

    ends = []
    for start in starts:
        guess = np.log(np.clip(np.concatenate([start.stiffness, start.damping]), low, high))
        ends.append(
            minimize(
                cost,
                guess,
                method="Nelder-Mead",
                bounds=[(np.log(low), np.log(high))] * len(guess),
                options={"maxfev": EVALUATIONS, "xatol": 1e-3, "fatol": 1e-6, "adaptive": True},
            )
        )
    best = min(ends, key=lambda end: float(end.fun))
    gains = _gains(best.x)
    both = np.concatenate([gains.stiffness, gains.damping])
    n = len(both) // 2
    names = [f"K{i + 1}" for i in range(n)] + [f"B{i + 1}" for i in range(n)]
    stuck = (both < low * 1.01) | (both > high / 1.01)
    return GainSearch(
        gains=gains,
        value=float(best.fun),
        at_bounds=tuple(name for name, is_stuck in zip(names, stuck, strict=True) if is_stuck),
        converged=bool(best.success),
    )


def _gains(logarithms: FloatArray) -> JointGains:
    values = np.exp(logarithms)
    n = len(values) // 2
    return JointGains(values[:n], values[n:])
