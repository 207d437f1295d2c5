"""Spot, spots_of: joints at which laws are hidden, in units in which each moves as a pendulum."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.effects.law import LawKind, joints_of
from ves_twin.machines.mjcf.inputs.programmes import joint_of
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.rig.description import Mode
from ves_twin.machines.mjcf.rig.places import driven_joint, typical_span

SPEED, TRAVEL = 5.0, 1.5
"""Largest speed and position of the shipped pendulum under its multisine [rad/s, rad], about:
shapes of hidden laws bend within these."""


@dataclass(frozen=True)
class Spot:
    """A joint at which laws are hidden.

    Attributes:
        joint: name.
        effort: typical one [N or N m].
        speed: unit of its speed.
        travel: unit of its position.
        actuator: that is commanded there; empty if none is.
        columns: "position" or "speed" -> compared column that reads it, and its typical span.
    """

    joint: str
    effort: float
    speed: float
    travel: float
    actuator: str = ""
    columns: Mapping[str, tuple[str, float]] = field(default_factory=dict)


PENDULUM = Spot(
    "joint", 1.0, 1.0, 1.0, "drive",
    {"position": ("joint.angle", 1.0), "speed": ("joint.rate", 1.0)},
)  # fmt: skip
"""The shipped one: its typical sizes are 1."""


def spots_of(forward: MjcfForward, programme: Excitation) -> tuple[Spot, ...]:
    """Joints of a machine at which a diagnosis may find a law.

    Args:
        forward: the machine.
        programme: in which it moves as it will be recorded.
    """
    told, model, places = forward.rig.description, forward.rig.model, forward.law_places()
    along, commands = forward.visited(programme, {}), {}
    if told.drive.mode is Mode.CONTROL:
        commands = {driven_joint(model, name): name for name in told.drive.actuators}
    columns: dict[str, dict[str, tuple[str, float]]] = {}
    read = {place.name for place in places if place.kind is LawKind.READING}
    for channel in forward.channels:
        compared = told.compare[channel.signal]
        if compared.joint and channel.name in read:
            span = typical_span(channel.signal, told)
            columns.setdefault(compared.joint, {})[compared.of] = channel.name, span

    def reach(name: str) -> float:
        return float(np.max(np.abs(along[name])))

    joints = [p.name for p in places if p.kind is LawKind.EFFORT and len(joints_of(p.name)) == 1]
    return tuple(
        Spot(
            joint,
            joint_of(forward.rig, joint).effort,
            reach(f"speed@{joint}") / SPEED,
            reach(f"position@{joint}") / TRAVEL,
            commands.get(joint, ""),
            columns.get(joint, {}),
        )
        for joint in joints
    )
