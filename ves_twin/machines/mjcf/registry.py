"""RIG_EFFECTS: every kind of effect that any rig can have, by name."""

from __future__ import annotations

from collections.abc import Mapping

from ves_twin.core.errors import UnknownNameError
from ves_twin.core.plugins import Registry, lacks
from ves_twin.machines.mjcf import (
    coupling_effects,
    friction_effects,
    joint_effects,
    part_effects,
    signal_effects,
)
from ves_twin.machines.mjcf.effect import RigEffect

_KINDS: tuple[type[RigEffect], ...] = (
    joint_effects.ViscousFriction,
    joint_effects.CoulombFriction,
    joint_effects.ViscousAsymmetry,
    joint_effects.CoulombAsymmetry,
    joint_effects.ForceOffset,
    joint_effects.JointSpring,
    joint_effects.RotorInertia,
    joint_effects.Backlash,
    friction_effects.QuadraticDrag,
    friction_effects.StribeckFriction,
    friction_effects.FrictionBehindGap,
    coupling_effects.CouplingInertia,
    coupling_effects.CouplingViscous,
    coupling_effects.CouplingCoulomb,
    part_effects.ActuatorGain,
    part_effects.ActuatorDelay,
    part_effects.BodyMass,
    part_effects.MassCentre,
    part_effects.BodyInertia,
    signal_effects.SensorGain,
    signal_effects.CrossTalk,
    signal_effects.SensorOffset,
    signal_effects.SensorDrift,
    signal_effects.SensorDelay,
)

RIG_EFFECTS: Registry[type[RigEffect]] = Registry(
    "ves_twin.rig_effects", {kind.kind: kind for kind in _KINDS}, lacks(RigEffect)
)
"""Kind -> class; installed packages add kinds by entry points of this group."""


def build_rig_effect(kind: str, target: str, sizes: Mapping[str, float]) -> RigEffect:
    """An effect by names.

    Raises:
        UnknownNameError: no such kind or size; says the nearest one.
    """
    if kind not in RIG_EFFECTS:
        raise UnknownNameError("effect", kind, RIG_EFFECTS)
    found = RIG_EFFECTS[kind]
    known = found(target).sizes
    for name in sizes:
        if name not in known:
            raise UnknownNameError(f"size of {kind}", name, known)
    return found(target, **sizes)
