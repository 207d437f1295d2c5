"""arm_servo: the motion controller's joint servo: spline between commands, PID on each joint."""

from __future__ import annotations

import numpy as np

from ves_twin.core.compiled import compiled
from ves_twin.core.types import FloatArray, Record

PARAMETERS = np.dtype(
    [
        ("stiffness", np.float64, 3),
        ("damping", np.float64, 3),
        ("integral", np.float64, 3),
        ("limit", np.float64, 3),
        ("cycle", np.float64),
    ]
)
"""stiffness [N m/rad], damping [N m s/rad], integral [N m/rad/s], limit [N m] of each joint;
cycle: time between two commands [s]."""

STATE = np.dtype(
    [
        ("points", np.float64, (4, 3)),
        ("integral", np.float64, 3),
        ("feedforward", np.float64, 3),
    ]
)
"""points: commands k-1, k, k+1, k+2 [rad]; integral: torque of the integrator [N m];
feedforward: torque that the computers add, held for a cycle [N m]."""


@compiled
def spline(points: FloatArray, u: float, cycle: float, q: FloatArray, rate: FloatArray) -> None:
    """Set-point and its rate on a uniform cubic B-spline, u from 0 to 1 between commands k and k+1.

    The blend looks two commands ahead, and smooths: at a command the path is
    (p_{k-1} + 4 p_k + p_{k+1}) / 6.

    Args:
        points: commands k-1 to k+2 [rad] (4, 3).
        u: fraction of the cycle.
        cycle: time between commands [s].
        q: set-point [rad] (3,), result.
        rate: its rate [rad/s] (3,), result.

    Source: thesis 2.4.3 (two commands of look-ahead); the kind of spline is assumed.
    """
    v = 1.0 - u
    w0, w3 = v * v * v / 6.0, u * u * u / 6.0
    w1 = (4.0 - 6.0 * u * u + 3.0 * u * u * u) / 6.0
    w2 = 1.0 - w0 - w1 - w3
    r0, r3 = -0.5 * v * v, 0.5 * u * u
    r1 = 1.5 * u * u - 2.0 * u
    r2 = -r0 - r1 - r3
    for j in range(3):
        q[j] = w0 * points[0, j] + w1 * points[1, j] + w2 * points[2, j] + w3 * points[3, j]
        rate[j] = (
            r0 * points[0, j] + r1 * points[1, j] + r2 * points[2, j] + r3 * points[3, j]
        ) / cycle


@compiled
def servo_torque(
    p: Record,
    added: FloatArray,
    q_set: FloatArray,
    rate_set: FloatArray,
    q: FloatArray,
    rate: FloatArray,
    torque: FloatArray,
) -> None:
    """Joint torques K (q_set - q) + B (q_set' - q') + added, limited to what the drives give.

    Args:
        p: PARAMETERS.
        added: torque of integrator and feed-forward [N m] (3,).
        q_set: set-point [rad] (3,).
        rate_set: its rate [rad/s] (3,).
        q: joint angles [rad] (3,).
        rate: joint rates [rad/s] (3,).
        torque: result [N m] (3,).
    """
    for j in range(3):
        t = p.stiffness[j] * (q_set[j] - q[j]) + p.damping[j] * (rate_set[j] - rate[j])
        torque[j] = min(max(t + added[j], -p.limit[j]), p.limit[j])
