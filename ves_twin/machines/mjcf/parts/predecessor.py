"""predecessor: the joint before another that turns, or slides, about the same axis."""

from __future__ import annotations

from collections.abc import Collection

import mujoco
import numpy as np

from ves_twin.machines.mjcf.parts.chain import chain

PARALLEL = 0.99
"""Cosine from which two axes count as one: 8 degrees of drawing and mounting."""


def predecessor(
    model: mujoco.MjModel, joint: str, among: Collection[str]
) -> tuple[str, float] | None:
    """Whose motion an angle has in it that is measured from the world.

    With theta an angle from the world, as an inclinometer or a camera tells it, the joint's own is
    q = theta - s theta', theta' being that of the nearest joint before it with a parallel axis and
    s = +-1 the direction of that axis. Of slides the same in lengths. None where a measured joint
    between the two turns about another axis: angles of a spatial arm do not add up.

    Args:
        model: at its home, where axes are compared.
        joint: whose reading it may be.
        among: joints that were measured.

    Returns:
        That joint and s; None where there is none.
    """
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    own = model.joint(joint).id
    kinds, bodies = model.jnt_type, model.jnt_bodyid
    before = set(chain(model, int(bodies[own])))
    for other in range(own - 1, -1, -1):  # joints are numbered from the world on
        along = float(np.dot(data.xaxis[own], data.xaxis[other]))
        name = model.joint(other).name
        if int(bodies[other]) not in before or name not in among:
            continue
        parallel = abs(along) > PARALLEL
        if parallel and kinds[other] == kinds[own]:
            return name, float(np.sign(along))
        if not parallel and kinds[other] == int(mujoco.mjtJoint.mjJNT_HINGE):
            return None
    return None
