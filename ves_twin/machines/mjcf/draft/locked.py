"""locked_joints: joints that no column tells and nothing measured hangs on: grippers, casters."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco

from ves_twin.machines.mjcf.draft.match import Match
from ves_twin.machines.mjcf.draft.spots import Quantity, single_joints
from ves_twin.machines.mjcf.parts.chain import chain
from ves_twin.machines.mjcf.parts.loops import has_loops
from ves_twin.machines.mjcf.parts.ties import Follower, Ties
from ves_twin.machines.mjcf.rig.places import driven_joint, tendon_joints

LIGHT = 0.1
"""Share of what a measured joint carries up to which a part may hang on a joint that nothing
drives and be taken as fixed: a load on a rope is more, a finger less."""

FEW = 6
"""Joints that are told by name."""


def locked_joints(model: mujoco.MjModel, found: Sequence[Match]) -> tuple[str, ...]:
    """Hinges and slides that are taken as standing still, in the order of the model.

    They have no column, no joint with one hangs on them, and they are driven (by what, no column
    tells), follow a driven one, or carry little. A whole robot's model beside the log of its arm.
    Those that an equality ties to a joint with a column follow it, and are none.

    Returns:
        None of a machine without actuators, whose loops close, or without a measured position.
    """
    told = {m.spot.joint or m.spot.name for m in found if m.spot.quantity is not Quantity.SENSOR}
    if (
        not model.nu
        or has_loops(model)
        or Quantity.POSITION not in {m.spot.quantity for m in found}
    ):
        return ()
    names = [model.joint(i).name for i in single_joints(model)]
    told |= {one.joint for one in Ties.of(model, told).followers}
    bodies = {name: int(model.joint(name).bodyid[0]) for name in names}
    measured = [bodies[name] for name in names if name in told]
    moved = _moved(model)
    return tuple(
        name
        for name, body in bodies.items()
        if name not in told
        and (name in moved or _is_light(model, body, measured))
        and not any(body in chain(model, other) for other in measured)
    )


def words_of_locked(names: Sequence[str], followers: Sequence[Follower]) -> list[str]:
    """Sentences for people; none where nothing is locked, and nothing follows."""
    few = [*names[:FEW], *([f"{len(names) - FEW} more"] if len(names) > FEW else [])]
    words = f"no column tells {', '.join(few)}: taken as locked; if one moved, name its column"
    return [words] * bool(names) + [
        f"{one.joint} follows {one.leader} as the model has it (equality): what it needs is needed"
        f" at {one.leader}"
        for one in followers
    ]


def _moved(model: mujoco.MjModel) -> set[str]:
    """Joints that an actuator moves, itself or by a tendon, or that an equality ties to one."""
    found = {driven_joint(model, i) for i in range(model.nu)}
    on_tendon = model.actuator_trntype == int(mujoco.mjtTrn.mjTRN_TENDON)
    for tendon in model.actuator_trnid[on_tendon, 0].tolist():
        found |= {joint for joint, _ in tendon_joints(model, tendon)}
    for one, two in _ties(model):
        found |= {one, two} if found & {one, two} else set()
    return found


def _ties(model: mujoco.MjModel) -> list[tuple[str, str]]:
    """Two joints each that an equality ties to one another."""
    every = zip(model.eq_type, model.eq_obj1id, model.eq_obj2id, strict=True)
    joint = int(mujoco.mjtEq.mjEQ_JOINT)
    ends = [(int(a), int(b)) for kind, a, b in every if int(kind) == joint]
    return [(model.joint(a).name, model.joint(b).name) for a, b in ends if min(a, b) >= 0]


def _is_light(model: mujoco.MjModel, body: int, measured: Sequence[int]) -> bool:
    """Whether a body with all it carries is little of what a measured joint carries."""
    before = (at for at in chain(model, body) if at != body and at in measured)
    above = next(before, 0)
    mass = model.body_subtreemass
    return bool(above and mass[body] <= LIGHT * mass[above])
