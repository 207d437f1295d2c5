"""untold: actuators that no column tells and that move no single joint, at rest in a simulation."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco

from ves_twin.machines.mjcf.draft.match import Match
from ves_twin.machines.mjcf.draft.spots import Quantity
from ves_twin.machines.mjcf.rig.places import driven_joint, tendon_joints

FEW = 6
"""Actuators that are told by name."""


def untold(model: mujoco.MjModel, found: Sequence[Match], locked: Sequence[str]) -> list[str]:
    """A sentence about thrusters, motors on tendons and the like without a column; none if none.

    Of a motor at one joint the mode tells.

    Args:
        model: of the machine.
        found: columns as they are meant.
        locked: joints that are taken as standing still, with what moves them.
    """
    told = {m.spot.name for m in found if m.spot.quantity is Quantity.EFFORT}
    names = [
        model.actuator(i).name or f"actuator {i}"
        for i in range(model.nu)
        if model.actuator(i).name not in told
        and not driven_joint(model, i)
        and not _on_locked(model, i, locked)
    ]
    few = [*names[:FEW], *([f"{len(names) - FEW} more"] if len(names) > FEW else [])]
    words = f"no column tells what commands {', '.join(few)}: at rest in every simulation"
    return [f"{words}; if they acted, name their columns"] if names else []


def _on_locked(model: mujoco.MjModel, actuator: int, locked: Sequence[str]) -> bool:
    """Whether an actuator pulls a tendon all of whose joints are locked."""
    if int(model.actuator_trntype[actuator]) != int(mujoco.mjtTrn.mjTRN_TENDON):
        return False
    joints = tendon_joints(model, int(model.actuator_trnid[actuator, 0]))
    return all(joint in locked for joint, _ in joints)
