"""chambers: pressure hydraulics, a four-way servovalve feeding two chambers of each cylinder."""

from __future__ import annotations

import numpy as np

from ves_twin.core.compiled import compiled
from ves_twin.core.types import FloatArray, Record

PARAMETERS = np.dtype(
    [
        ("area", np.float64, 2),
        ("dead_volume", np.float64, 6),
        ("half_stroke", np.float64),
        ("bulk_modulus", np.float64, 6),
        ("rated", np.float64),
        ("flow_gain", np.float64, 2),
        ("crossover", np.float64),
        ("leakage", np.float64, 6),
        ("conductance", np.float64, 2),
        ("null", np.float64, 2),
        ("viscous", np.float64, 6),
    ]
)
"""area of piston and annulus [m^2]; dead volume of a side [m^3]; half stroke [m]; effective bulk
modulus [Pa]; supply at which the valve is rated [Pa]; flow at full opening per root pressure of
the two ports [m^3/s/Pa^0.5]; pressure below which an orifice is laminar [Pa]; piston leakage and
valve null conductances [m^3/s/Pa]; pressures at null without load at the rated supply [Pa];
viscous friction [N s/m]. Those with six values are per leg."""

STATE = np.dtype([("pressure", np.float64, (6, 2))])
"""Pressures of the piston and the annulus side of each leg [Pa]."""


@compiled
def orifice(gain: float, drop: float, crossover: float) -> tuple[float, float]:
    """Flow through an orifice, q = K dp / (dp^2 + dp0^2)^(1/4), and its slope dq/d(dp).

    The square-root law away from zero, linear within the crossover pressure dp0.

    Args:
        gain: K [m^3/s/Pa^0.5].
        drop: pressure drop dp [Pa].
        crossover: dp0 [Pa].

    Returns:
        Flow [m^3/s] and slope [m^3/s/Pa].
    """
    square = np.sqrt(drop * drop + crossover * crossover)
    root = np.sqrt(square)
    return gain * drop / root, gain * (1.0 / root - 0.5 * drop * drop / (square * square * root))


@compiled
def growth(z: float) -> float:
    """(e^z - 1) / z, the exact answer of p' = f + a p over a step with z = a h."""
    return np.expm1(z) / z if abs(z) > 1e-9 else 1.0


@compiled
def push_rods_by_pressure(
    p: Record,
    s: Record,
    force: FloatArray,
    spool: FloatArray,
    slide: FloatArray,
    speed: FloatArray,
    supply: float,
    step: float,
) -> tuple[float, float]:
    """Advance the chamber pressures by a step and give the rod forces.

    With x the mean opening over the step, q the rod travel and v its speed,

        p1' = beta / V1 (qA + cv (n1 - p1) - cl (p1 - p2) - A1 v)
        p2' = beta / V2 (qB + cv R^-1 (n2 - p2) + cl (p1 - p2) + A2 v)
        F = A1 p1 - A2 p2 - b v

    qA comes from the supply for x > 0 and goes to the tank for x < 0, qB the other way. The null
    conductance of a port is two laminar leaks in parallel with its lands, to the supply and to the
    tank, which balance at n; n follows the supply. Each
    chamber advances exponentially with its own slope, so that one sub-step in a tick is enough.

    Args:
        p: PARAMETERS.
        s: STATE.
        force: result [N] (6,).
        spool: mean opening over the step, -1 to 1 (6,).
        slide: rod travel from home [m] (6,).
        speed: rod speed [m/s] (6,).
        supply: manifold pressure, held over the step [Pa].
        step: physics step h [s].

    Returns:
        Flow that the six valves draw from the manifold at the start of the step [m^3/s], and its
        slope over the manifold pressure [m^3/s/Pa].

    Source: Merritt, Hydraulic Control Systems (1967), chapters 3, 5 and 6, for the equations.
    """
    demand, demand_slope = 0.0, 0.0
    share = supply / p.rated
    n1, n2 = p.null[0] * share, p.null[1] * share
    for i in range(6):
        beta, dead = p.bulk_modulus[i], p.dead_volume[i]
        smallest = 0.2 * dead  # beyond the stroke the volume must stay positive
        p1, p2, x, v = s.pressure[i, 0], s.pressure[i, 1], spool[i], speed[i]
        middle = slide[i] + 0.5 * v * step
        v1 = max(dead + p.area[0] * (p.half_stroke + middle), smallest)
        v2 = max(dead + p.area[1] * (p.half_stroke - middle), smallest)
        if x >= 0.0:
            qa, slope_a = orifice(p.flow_gain[0] * x, supply - p1, p.crossover)
            qb, slope_b = orifice(p.flow_gain[1] * x, p2, p.crossover)
            demand, demand_slope = demand + qa, demand_slope + slope_a
            qb = -qb
        else:
            qa, slope_a = orifice(-p.flow_gain[0] * x, p1, p.crossover)
            qb, slope_b = orifice(-p.flow_gain[1] * x, supply - p2, p.crossover)
            demand, demand_slope = demand + qb, demand_slope + slope_b
            qa = -qa
        for port in range(2):
            leak = p.conductance[port] * p.null[port] / p.rated
            demand += leak * (supply - s.pressure[i, port])
            demand_slope += leak
        across = p.leakage[i] * (p1 - p2)
        rate1 = beta / v1 * (qa + p.conductance[0] * (n1 - p1) - across - p.area[0] * v)
        rate2 = beta / v2 * (qb + p.conductance[1] * (n2 - p2) + across + p.area[1] * v)
        decay1 = -beta / v1 * (slope_a + p.conductance[0] + p.leakage[i])
        decay2 = -beta / v2 * (slope_b + p.conductance[1] + p.leakage[i])
        p1 = max(p1 + step * rate1 * growth(decay1 * step), 0.0)
        p2 = max(p2 + step * rate2 * growth(decay2 * step), 0.0)
        s.pressure[i, 0], s.pressure[i, 1] = p1, p2
        force[i] = p.area[0] * p1 - p.area[1] * p2 - p.viscous[i] * v
    return demand, demand_slope
