"""at_leader, felt_inertia: efforts of joints that follow measured ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import mujoco

from ves_twin.machines.mjcf.draft.match import Match
from ves_twin.machines.mjcf.parts.ties import Follower


def at_leader(effort: Match, leads: Mapping[str, Follower]) -> Match:
    """The effort of a joint that follows a measured one, as that one's."""
    joint = effort.spot.joint
    while joint in leads:
        joint = leads[joint].leader
    return replace(effort, spot=replace(effort.spot, joint=joint))


def felt_inertia(
    efforts: Sequence[Match], leads: Mapping[str, Follower], model: mujoco.MjModel
) -> dict[str, float]:
    """Inertia that a motor feels whose joint y follows a measured one, x: J_x dx/dy + J_y dy/dx."""
    found = {}
    for m in efforts:
        joint, ratio = m.spot.joint, 1.0
        while joint in leads:
            joint, ratio = leads[joint].leader, ratio * abs(leads[joint].powers[1])
        if joint != m.spot.joint and ratio > 0.0:
            own, other = (
                float(model.dof_M0[int(model.joint(name).dofadr[0])])
                for name in (m.spot.joint, joint)
            )
            found[joint] = other / ratio + own * ratio
    return found
