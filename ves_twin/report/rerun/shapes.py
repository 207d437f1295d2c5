"""send_shapes: the geoms of MuJoCo bodies as static rerun primitives."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import mujoco
import numpy as np
import rerun as rr

from ves_twin.core.types import FloatArray

FLOOR_HALF_SIZE = 3.0
FLOOR_HALF_DEPTH = 0.005
"""Half extents [m] of the thin box that stands for an unbounded plane."""


@dataclass(frozen=True)
class Placed:
    """One geom in the axes of its body.

    Attributes:
        size: MuJoCo's half sizes [m] (3,).
        centre: centre in the body [m] (3,).
        turn: quaternion x, y, z, w in the body (4,).
        colour: red, green, blue, opacity, 0 to 255 (4,).
    """

    size: FloatArray
    centre: FloatArray
    turn: FloatArray
    colour: tuple[int, int, int, int]


def send_shapes(
    stream: rr.RecordingStream,
    root: str,
    model: mujoco.MjModel,
    bodies: tuple[str, ...],
    colour: tuple[int, int, int, int] | None = None,
    grow: float = 0.0,
) -> None:
    """Send every geom of some bodies as a child entity of its body, without a time.

    Args:
        stream: where it goes.
        root: entity above the bodies, for instance "machine".
        model: the compiled rig.
        bodies: names of the bodies.
        colour: one colour for all (0 to 255, with opacity) in place of the geoms' own.
        grow: outward shift of every surface [m], so that two coincident bodies do not flicker.
    """
    for geom in range(model.ngeom):
        body = model.body(model.geom_bodyid[geom]).name
        make = _MAKERS.get(mujoco.mjtGeom(model.geom_type[geom]))
        if body not in bodies or make is None:
            continue
        name = model.geom(geom).name.rsplit("/", 1)[-1] or f"geom{geom}"
        shape = make(_placed(model, geom, colour, grow))
        stream.log(f"{root}/{body}/{name}", shape, static=True)


def _placed(
    model: mujoco.MjModel, geom: int, colour: tuple[int, int, int, int] | None, grow: float
) -> Placed:
    red, green, blue, opacity = (round(255 * float(c)) for c in model.geom_rgba[geom])
    return Placed(
        size=np.array(model.geom_size[geom]) + grow,
        centre=np.array(model.geom_pos[geom]),
        turn=np.array(model.geom_quat[geom])[[1, 2, 3, 0]],
        colour=colour or (red, green, blue, opacity),
    )


def _plane(geom: Placed) -> rr.AsComponents:
    half = np.where(geom.size[:2] > 0, geom.size[:2], FLOOR_HALF_SIZE)
    size = np.array([*half, FLOOR_HALF_DEPTH])
    # the box hangs below the plane, so that its top lies where the plane is
    below = geom.centre - np.array([0.0, 0.0, FLOOR_HALF_DEPTH])
    return _box(Placed(size, below, geom.turn, geom.colour))


def _box(geom: Placed) -> rr.AsComponents:
    return rr.Boxes3D(
        half_sizes=[geom.size],
        centers=[geom.centre],
        quaternions=[geom.turn],
        colors=[geom.colour],
        fill_mode=rr.components.FillMode.Solid,
    )


def _cylinder(geom: Placed) -> rr.AsComponents:
    return rr.Cylinders3D(
        lengths=[2.0 * geom.size[1]],
        radii=[geom.size[0]],
        centers=[geom.centre],
        quaternions=[geom.turn],
        colors=[geom.colour],
        fill_mode=rr.components.FillMode.Solid,
    )


def _capsule(geom: Placed) -> rr.AsComponents:
    # rerun puts a capsule's origin at the centre of its lower cap, MuJoCo at its middle
    turn = np.empty(9)
    mujoco.mju_quat2Mat(turn, geom.turn[[3, 0, 1, 2]])
    start = geom.centre - turn.reshape(3, 3)[:, 2] * geom.size[1]
    return rr.Capsules3D(
        lengths=[2.0 * geom.size[1]],
        radii=[geom.size[0]],
        translations=[start],
        quaternions=[geom.turn],
        colors=[geom.colour],
        fill_mode=rr.components.FillMode.Solid,
    )


def _sphere(geom: Placed) -> rr.AsComponents:
    return _ellipsoid(Placed(np.full(3, geom.size[0]), geom.centre, geom.turn, geom.colour))


def _ellipsoid(geom: Placed) -> rr.AsComponents:
    return rr.Ellipsoids3D(
        half_sizes=[geom.size],
        centers=[geom.centre],
        quaternions=[geom.turn],
        colors=[geom.colour],
        fill_mode=rr.components.FillMode.Solid,
    )


_MAKERS: dict[mujoco.mjtGeom, Callable[[Placed], rr.AsComponents]] = {
    mujoco.mjtGeom.mjGEOM_PLANE: _plane,
    mujoco.mjtGeom.mjGEOM_BOX: _box,
    mujoco.mjtGeom.mjGEOM_CYLINDER: _cylinder,
    mujoco.mjtGeom.mjGEOM_CAPSULE: _capsule,
    mujoco.mjtGeom.mjGEOM_SPHERE: _sphere,
    mujoco.mjtGeom.mjGEOM_ELLIPSOID: _ellipsoid,
}
