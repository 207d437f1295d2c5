"""law_places: where a law may act on an MJCF machine, and on what it may depend."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations, product

import numpy as np

from ves_twin.core.units import to_si
from ves_twin.diagnosis.model.forward import Channel
from ves_twin.diagnosis.model.law_forward import LawPlace, Variable
from ves_twin.effects.law import SIGNS, WITHIN, LawKind
from ves_twin.machines.mjcf.parts.joint_units import joint_units
from ves_twin.machines.mjcf.rig.description import Mode, Span
from ves_twin.machines.mjcf.rig.machine import Rig
from ves_twin.machines.mjcf.rig.places import SINGLE, driven_joint

EFFORT_SHARE = 0.3
"""Size that a law of efforts is expected to have, as a share of the typical effort: the amplitude
that a machine is driven with."""

READING_SHARE = 0.03
"""The same of a column, as a share of its typical span: what a sensor that works may be off."""


PLAYS = np.geomspace(0.02, 0.64, 11)
"""Widths of a play, as shares of the typical travel; each two fifths more than the last one."""


def law_places(rig: Rig, channels: Sequence[Channel], mode: Mode) -> tuple[LawPlace, ...]:
    """Hinges and slides with a typical effort, and compared columns with a typical span.

    Where motion is fed in, a law of what an actuator reads is one of the effort at its joint;
    prediction being quick there, joints are tried two by two as well, and so is where each stands
    within a play. A joint whose effort nobody compares shows no law then.
    """
    told, model, found = rig.description, rig.model, []
    clock = Variable("time", "s")
    shown = {driven_joint(model, one.actuator) for one in told.compare.values() if one.actuator}
    for number in range(model.njnt):
        joint = model.joint(number)
        span = told.typical.joint.get(joint.name, Span())
        if int(joint.type[0]) not in SINGLE or not span.effort:
            continue
        if mode is Mode.MOTION and joint.name not in shown:
            continue
        unit = "N*m" if joint_units(model, joint.name)[0] == "rad" else "N"
        size = EFFORT_SHARE * to_si(span.effort, unit, f"typical.joint.{joint.name}.effort")
        plays = _plays(rig, joint.name) if mode is Mode.MOTION else ()
        of = (*_motion(rig, joint.name), clock, *plays, *_commands(rig, joint.name, mode))
        found.append(LawPlace(joint.name, LawKind.EFFORT, unit, size, of))
    found += _pairs(found) if mode is Mode.MOTION else []
    for channel in channels:
        compared = told.compare[channel.signal]
        span = told.typical.signal.get(channel.signal, Span())
        if not span.span or (mode is Mode.MOTION and compared.actuator):
            continue
        size = READING_SHARE * to_si(span.span, channel.unit, f"typical.signal.{channel.signal}")
        own = _motion(rig, compared.joint) if compared.joint else ()
        of = (*own, clock, *(_commands(rig, compared.joint, mode) if own else ()))
        found.append(LawPlace(channel.name, LawKind.READING, channel.unit, size, of))
    return tuple(found)


def _motion(rig: Rig, joint: str) -> tuple[Variable, ...]:
    """A joint's own position and speed, then those of the others, where a column tells them.

    Of a joint that none tells a simulation alone knows where it is: one that ran away to 54 rad was
    given a law by which it swung there (a measured arm, its elbow's column left out).
    """
    model, told = rig.model, rig.description
    seen = {*told.drive.joints, *(one.joint for one in told.compare.values())}
    felt = any(one.sensor for one in told.compare.values())  # which may tell any joint
    names = [model.joint(n).name for n in range(model.njnt) if int(model.jnt_type[n]) in SINGLE]
    found = []
    for name in [joint, *(other for other in names if other != joint)]:
        if name not in seen and not felt:
            continue
        position, speed = joint_units(model, name)
        found += [Variable(f"position@{name}", position), Variable(f"speed@{name}", speed)]
    return tuple(found)


def _plays(rig: Rig, joint: str) -> tuple[Variable, ...]:
    """Where a joint stands within plays of several widths; none where nobody says its travel."""
    told = rig.description.typical.joint.get(joint, Span())
    unit = joint_units(rig.model, joint)[0]
    travel = to_si(told.travel, unit, f"typical.joint.{joint}.travel") if told.travel else 0.0
    widths = PLAYS * travel if travel else ()
    return tuple(Variable(f"position@{joint}{WITHIN}{width:.3g}", unit) for width in widths)


def _pairs(single: Sequence[LawPlace]) -> list[LawPlace]:
    """Two joints of one sort together, or against one another, by their sum or difference."""
    found = []
    for (one, two), sign in product(combinations(single, 2), SIGNS):
        if one.unit != two.unit or not (_told(one) and _told(two)):
            continue
        name = f"{one.name}{sign}{two.name}"
        units = {v.what: v.unit for v in reversed(one.variables)}
        of = tuple(Variable(f"{what}@{name}", units[what]) for what in ("position", "speed"))
        scale = min(one.scale, two.scale)
        found.append(LawPlace(name, LawKind.EFFORT, one.unit, scale, of))
    return found


def _told(place: LawPlace) -> bool:
    """Whether a column tells the motion of the joint itself."""
    return {f"position@{place.name}", f"speed@{place.name}"} <= {v.name for v in place.variables}


def _commands(rig: Rig, joint: str, mode: Mode) -> tuple[Variable, ...]:
    """What is commanded of the actuators of a joint, where motion follows from it."""
    if mode is Mode.MOTION:
        return ()
    told, model = rig.description, rig.model
    names = [*told.drive.actuators, *told.controllers]
    own = [n for n in dict.fromkeys(names) if driven_joint(model, n) == joint]
    return tuple(Variable(f"command@{name}", "") for name in own)
