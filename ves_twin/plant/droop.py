"""frozen_droop: how far a frozen platform sinks and tilts, its valves at null, in a given time."""

from __future__ import annotations

import mujoco
import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.kinematics.stewart import pose_jacobian
from ves_twin.plant.assembly import assemble, compile_model
from ves_twin.plant.hydraulics import fill_chambers
from ves_twin.plant.layout import Layout
from ves_twin.plant.physics import chambers
from ves_twin.plant.plant import Plant
from ves_twin.plant.statics import place_rig, static_leg_forces

_STEPS = 8
"""Runge-Kutta steps over the time; twice as many change a droop of 0.5 deg by less than 1e-6."""


def creep_speed(p: np.void, force: FloatArray) -> FloatArray:
    """Speed [m/s] (6,) of rods that carry forces (6,) [N] with the spools at null.

    The steady state of `push_rods_by_pressure` without spool: what leaks through the null of the
    valve and past the piston lets the rod move,

        c1 (n1 - p1) - cl (p1 - p2) = A1 v,  c2 (n2 - p2) + cl (p1 - p2) = -A2 v,
        A1 p1 - A2 p2 - b v = F,

    c the null conductances, cl the piston leakage, n the pressures at null without load.

    Args:
        p: one record of `chambers.PARAMETERS`.
        force: forces of the cylinders, pushing the platform up positive [N] (6,).
    """
    (a1, a2), (c1, c2), (n1, n2) = p["area"], p["conductance"], p["null"]
    leak, viscous = np.broadcast_to(p["leakage"], 6), np.broadcast_to(p["viscous"], 6)
    if not c1 + np.min(leak) > 0.0:
        raise InvalidInputError(
            "chamber", "no leakage at all", "a leak that lets frozen legs creep"
        )
    speed = np.empty(6)
    for i, (cl, b) in enumerate(zip(leak, viscous, strict=True)):
        system = np.array([[c1 + cl, -cl, a1], [cl, -(c2 + cl), a2], [a1, -a2, -b]])
        speed[i] = np.linalg.solve(system, [c1 * n1, -c2 * n2, force[i]])[2]
    return speed


def frozen_droop(
    plant: Plant, pose: FloatArray, q: FloatArray, spool: FloatArray, seconds: float
) -> FloatArray:
    """Pose [m, rad] (6,) that a platform frozen at `pose` has after a time, arm at rest at q.

    Creep is slow: the leg forces are those of statics all the way; the legs' own weight, which
    makes the full rig sink 14 % faster, is left out. Creep under load is linear in
    the wrench of the payload, so that by itself it would hide in a calibration matrix; where the
    spools come to rest differs from one freeze to the next.

    Args:
        plant: the world, its chambers and masses.
        pose: pose at which the platform was frozen [m, rad] (6,).
        q: joint angles [rad] (3,).
        spool: where the spools came to rest, -1 to 1 of full opening (6,).
        seconds: since then [s].

    Raises:
        UnreachableError: it creeps into a singular pose.
    """
    model = compile_model(assemble(plant, plant.actual.number("clock.tick")))
    data, layout, geometry = mujoco.MjData(model), Layout.of(model), plant.geometry
    block = np.zeros(1, chambers.PARAMETERS)
    fill_chambers(block[0], plant.actual)
    bias = plant.actual.number("hydraulics.full_speed") * spool

    def rate(at: FloatArray) -> FloatArray:
        place_rig(data, layout, geometry, at, q)
        force = static_leg_forces(model, data, layout, geometry, at)
        jacobian = pose_jacobian(at, geometry.base, geometry.top, geometry.home)
        return np.asarray(np.linalg.solve(jacobian, creep_speed(block[0], force) + bias))

    step = seconds / _STEPS
    at = np.array(pose, dtype=float)
    for _ in range(_STEPS):
        k1 = rate(at)
        k2 = rate(at + 0.5 * step * k1)
        k3 = rate(at + 0.5 * step * k2)
        k4 = rate(at + step * k3)
        at = at + step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    return at
