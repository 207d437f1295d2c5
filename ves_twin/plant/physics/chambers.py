"""chambers: pressure hydraulics, a four-way servovalve feeding two chambers of each cylinder."""

from __future__ import annotations

import numpy as np

from ves_twin.compiled import compiled
from ves_twin.types import FloatArray, Record

PARAMETERS = np.dtype(
    [
        ("area", np.float64, 2),
        ("dead_volume", np.float64),
        ("half_stroke", np.float64),
        ("bulk_modulus", np.float64),
        ("supply", np.float64),
        ("flow_gain", np.float64, 2),
        ("crossover", np.float64),
        ("leakage", np.float64),
        ("conductance", np.float64, 2),
        ("null", np.float64, 2),
        ("viscous", np.float64),
    ]
)
"""area of piston and annulus [m^2]; dead volume of a side [m^3]; half stroke [m]; effective bulk
modulus [Pa]; supply [Pa]; flow at full opening per root pressure of the two ports
[m^3/s/Pa^0.5]; pressure below which an orifice is laminar [Pa]; piston leakage and valve null
conductances [m^3/s/Pa]; pressures at null without load [Pa]; viscous friction [N s/m]."""

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
def _growth(z: float) -> float:
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
    step: float,
) -> None:
    """Advance the chamber pressures by a step and give the rod forces.

    With x the mean opening over the step, q the rod travel and v its speed,

        p1' = beta / V1 (qA + cv (n1 - p1) - cl (p1 - p2) - A1 v)
        p2' = beta / V2 (qB + cv R^-1 (n2 - p2) + cl (p1 - p2) + A2 v)
        F = A1 p1 - A2 p2 - b v

    qA comes from the supply for x > 0 and goes to the tank for x < 0, qB the other way. Each
    chamber advances exponentially with its own slope, so that one sub-step in a tick is enough.

    Args:
        p: PARAMETERS.
        s: STATE.
        force: result [N] (6,).
        spool: mean opening over the step, -1 to 1 (6,).
        slide: rod travel from home [m] (6,).
        speed: rod speed [m/s] (6,).
        step: physics step h [s].

    Source: Merritt, Hydraulic Control Systems (1967), chapters 3, 5 and 6, for the equations.
    """
    beta = p.bulk_modulus
    smallest = 0.2 * p.dead_volume  # beyond the stroke the volume must stay positive
    for i in range(6):
        p1, p2, x, v = s.pressure[i, 0], s.pressure[i, 1], spool[i], speed[i]
        middle = slide[i] + 0.5 * v * step
        v1 = max(p.dead_volume + p.area[0] * (p.half_stroke + middle), smallest)
        v2 = max(p.dead_volume + p.area[1] * (p.half_stroke - middle), smallest)
        if x >= 0.0:
            qa, slope_a = orifice(p.flow_gain[0] * x, p.supply - p1, p.crossover)
            qb, slope_b = orifice(p.flow_gain[1] * x, p2, p.crossover)
            qb = -qb
        else:
            qa, slope_a = orifice(-p.flow_gain[0] * x, p1, p.crossover)
            qb, slope_b = orifice(-p.flow_gain[1] * x, p.supply - p2, p.crossover)
            qa = -qa
        across = p.leakage * (p1 - p2)
        rate1 = beta / v1 * (qa + p.conductance[0] * (p.null[0] - p1) - across - p.area[0] * v)
        rate2 = beta / v2 * (qb + p.conductance[1] * (p.null[1] - p2) + across + p.area[1] * v)
        decay1 = -beta / v1 * (slope_a + p.conductance[0] + p.leakage)
        decay2 = -beta / v2 * (slope_b + p.conductance[1] + p.leakage)
        p1 = max(p1 + step * rate1 * _growth(decay1 * step), 0.0)
        p2 = max(p2 + step * rate2 * _growth(decay2 * step), 0.0)
        s.pressure[i, 0], s.pressure[i, 1] = p1, p2
        force[i] = p.area[0] * p1 - p.area[1] * p2 - p.viscous * v
