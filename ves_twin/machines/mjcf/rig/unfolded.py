"""unfolded: a machine's description with its shorthands written out for its model."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

import mujoco
import numpy as np

from ves_twin.core.errors import InvalidInputError, UnknownNameError, VesTwinError
from ves_twin.effects.actuators import (
    FROM,
    ActuatorAsymmetry,
    ActuatorOffset,
    ActuatorSaturation,
    DriveCrossTalk,
)
from ves_twin.effects.bodies import BodyInertia, BodyMass, BodyPlace, MassCentre, Payload
from ves_twin.effects.clock import CLOCK
from ves_twin.effects.effect import Effect
from ves_twin.effects.element import Element
from ves_twin.effects.friction import RegularizedFriction
from ves_twin.effects.joints import JointCompliance
from ves_twin.effects.presliding import DahlFriction, OneWayLoad
from ves_twin.effects.registry import EFFECTS, attributes, build_anywhere, kind_anywhere
from ves_twin.effects.ripple import Ripple
from ves_twin.effects.servos import ServoDamping, ServoStrength
from ves_twin.machines.mjcf.parts.chain import chain
from ves_twin.machines.mjcf.rig.description import Allowed, Mode, RigDescription, Setting
from ves_twin.machines.mjcf.rig.places import anywhere, driven_joint, place_of

ALL = "*"

OF_TURNING = (MassCentre.kind, BodyInertia.kind, Payload.kind)
"""Kinds that a body which only slides does not show."""

OF_LOADS = (BodyMass.kind, BodyInertia.kind)
"""Kinds that a "*" does not mean on a body that may carry a payload: it has them as its limits."""

FEW = 2
"""Numbers of a kind that a "*" means."""

BY_NAME = (
    *(ActuatorAsymmetry.kind, ActuatorOffset.kind, ActuatorSaturation.kind),
    *(OneWayLoad.kind, RegularizedFriction.kind, DahlFriction.kind),
    *(Ripple.kind, DriveCrossTalk.kind, JointCompliance.kind, ServoDamping.kind),
)
"""Kinds that a "*" does not mean: on most machines a force offset and dry or viscous friction do
much the same, as a spring and its compliance do, or a servo's damping and its joint's, each of them
costs runs, and nobody knows how many waves a ripple has. A file asks for these by their names."""

SLIDE = int(mujoco.mjtJoint.mjJNT_SLIDE)

Key = tuple[str, str]
"""Kind and target."""


def unfolded(told: RigDescription, model: mujoco.MjModel) -> RigDescription:
    """The description with a setting for each tolerance, and an entry for each effect of a "*".

    Args:
        told: the file as it was read.
        model: with the nominal values of the file.

    Raises:
        UnknownNameError: a tolerance of an attribute that no part of a model has.
        InvalidInputError: an effect on every place, where the model has none.
    """
    if not told.tolerances and not any(ALL in (a.kind, *a.on) for a in told.effects):
        return told
    settings = {_place(s): s for s in told.parameters}
    for new in _tolerances(told, model):
        old = settings.get(_place(new))
        if old is None or "sd" not in old.model_fields_set:
            settings[_place(new)] = old.model_copy(update={"sd": new.sd}) if old else new
    effects = tuple(_effects(told, model))
    return told.model_copy(update={"parameters": tuple(settings.values()), "effects": effects})


def _place(setting: Setting) -> tuple[object, ...]:
    return setting.element, setting.attribute


def _tolerances(told: RigDescription, model: mujoco.MjModel) -> Iterator[Setting]:
    """Of every named part that moves, has the attribute, and typical sizes where it needs any."""
    kinds = attributes()
    for attribute, share in told.tolerances.items():
        elements = [element for element, name in kinds if name == attribute]
        if not elements:
            raise UnknownNameError("attribute in tolerances", attribute, {a for _, a in kinds})
        for element in elements:
            for name in names_of(model, element):
                axis = attribute.removeprefix("centre_")
                target = name if axis == attribute else f"{name}.{axis}"
                effect = build_anywhere(kinds[element, attribute].kind, target, {})
                value = effect.present(model)
                if value != 0.0 and _sized(effect, told, model):
                    content = {"attribute": attribute, str(element): name, "sd": share * abs(value)}
                    yield Setting.model_validate(content)


def names_of(model: mujoco.MjModel, element: Element) -> list[str]:
    """Named parts of a kind; of bodies those that move, of the world its axes if things weigh."""
    found: list[str] = []
    if element is Element.BODY:
        found = [model.body(i).name for i in range(1, model.nbody) if model.body_weldid[i]]
    elif element is Element.JOINT:
        found = [model.joint(i).name for i in range(model.njnt)]
    elif element is Element.ACTUATOR:
        found = [model.actuator(i).name for i in range(model.nu)]
    elif element is Element.TENDON:
        found = [model.tendon(i).name for i in range(model.ntendon)]
    elif element is Element.WORLD:
        found = ["x", "y"] if np.any(model.opt.gravity) else []
    elif element is Element.LOG:
        found = [CLOCK]
    return [name for name in found if name]


def _effects(told: RigDescription, model: mujoco.MjModel) -> Iterator[Allowed]:
    """Entries of their own as they are, then what "*" adds to them."""
    own = [a for a in told.effects if ALL not in (a.kind, *a.on)]
    taken = {(kind_anywhere(a.kind).kind, target) for a in own for target in a.on}
    loaded = {target for kind, target in taken if kind == Payload.kind}
    taken |= {(kind, target) for kind in OF_LOADS for target in loaded}
    yield from own
    for one in told.effects:
        if ALL not in (one.kind, *one.on):
            continue
        kinds = [one.kind] if one.kind != ALL else _every()
        found: list[Key] = []
        for kind in kinds:
            targets = _targets(kind, told, model) if ALL in one.on else one.on
            found += [(kind_anywhere(kind).kind, target) for target in targets]
        fitting = [key for key in found if _fits(*key, told, model)]
        if not fitting:
            what, expected = f"effects: {one.kind} on {', '.join(one.on)}", "a place that has it"
            raise InvalidInputError(what, "none in the model with typical sizes", expected)
        for kind, target in fitting:
            if (kind, target) not in taken:
                taken.add((kind, target))
                yield one.model_copy(update={"kind": kind, "on": (target,)})


def _every() -> list[str]:
    """Kinds that a "*" means: those of at most two numbers.

    A law of more has others as its limits and takes their place: friction behind a gap that of a
    plain axis, which is then not found (EMPS). A file that asks for it by its name gets it.
    """
    found = [name for name, kind in EFFECTS.items() if kind.anywhere and len(kind.sizes) <= FEW]
    return [name for name in found if name not in BY_NAME]


def _fits(kind: str, target: str, told: RigDescription, model: mujoco.MjModel) -> bool:
    """Whether an effect can sit there and is not another one by another name."""
    effect = build_anywhere(kind, target, {})
    return _sized(effect, told, model) and not _is_alias(effect, told)


def _sized(effect: Effect, told: RigDescription, model: mujoco.MjModel) -> bool:
    """Whether the file tells the typical sizes that sizes of an effect follow from."""
    try:
        magnitudes = effect.magnitudes_at(place_of(effect, told, model))
    except VesTwinError:
        return False
    return all(m.smallest < m.largest for m in magnitudes)


def _targets(kind: str, told: RigDescription, model: mujoco.MjModel) -> list[str]:
    """Every target of a kind that a recording in the file's mode may show."""
    on = anywhere(build_anywhere(kind, "", {}))
    if on.element is Element.SIGNAL:
        return [t for name in _outputs(told) for t in _columns(name, on.columns, told)]
    names = names_of(model, on.element)
    if on.element is Element.ACTUATOR:
        fed = set(told.drive.actuators) if told.drive.mode is Mode.CONTROL else set(names)
        names = [name for name in names if name in fed]
        if kind == ServoStrength.kind:  # without a limit or a brake of its own it is a stiffness
            names = [name for name in names if _limited(name, model)]
        return _neighbours(names, model) if kind == DriveCrossTalk.kind else names
    led = bool(model.nu or told.drive.imposed or told.drive.mode is Mode.MOTION)
    if on.element is Element.LOG and led:
        return []  # commands and efforts are of the same clock: a file that doubts it says so
    if kind in OF_TURNING:
        names = [name for name in names if _turns(model, model.body(name).id)]
    if kind == BodyPlace.kind:
        names = [name for name in names if _turns(model, int(model.body(name).parentid[0]))]
    return [f"{name}.{axis}" for name in names for axis in "xyz"] if on.axis else names


def _limited(name: str, model: mujoco.MjModel) -> bool:
    """Whether a servo, or the joint it drives, has a limit of force, or it brakes."""
    at, joint = model.actuator(name).id, driven_joint(model, name)
    limited = joint and model.jnt_actfrclimited[model.joint(joint).id]
    own = model.actuator_forcelimited[at] or float(model.actuator_biasprm[at, 2]) != 0.0
    return bool(limited or own)


def _neighbours(names: list[str], model: mujoco.MjModel) -> list[str]:
    """Every two drives of which one moves the body that carries the other's, both ways."""
    joints = {name: driven_joint(model, name) for name in names}
    bodies = {n: int(model.joint(j).bodyid[0]) for n, j in joints.items() if j}
    found = []
    for one, other in combinations(bodies, 2):
        here, there = bodies[one], bodies[other]
        if here in (there, model.body_parentid[there]) or there == model.body_parentid[here]:
            found += [f"{one}{FROM}{other}", f"{other}{FROM}{one}"]
    return found


def _turns(model: mujoco.MjModel, body: int) -> bool:
    """Whether any joint between a body and the world lets it turn."""
    bodies = set(chain(model, body))
    kinds = zip(model.jnt_bodyid.tolist(), model.jnt_type.tolist(), strict=True)
    return any(at in bodies and kind != SLIDE for at, kind in kinds)


def _outputs(told: RigDescription) -> list[str]:
    """Signals that the file's mode predicts."""
    motion = told.drive.mode is Mode.MOTION
    places = told.compare.items()
    return [n for n, c in places if c.sensor or bool(c.actuator) == motion]


def _columns(name: str, count: int, told: RigDescription) -> list[str]:
    width = len(told.signals[name].columns)
    if count == 0:
        return [name]
    if count == 1:
        return [f"{name}.{i + 1}" for i in range(width)]
    pairs = ((i, k) for i in range(width) for k in range(width) if i != k)
    return [f"{name}.{i + 1}.{k + 1}" for i, k in pairs]


def _is_alias(effect: Effect, told: RigDescription) -> bool:
    """Whether an effect on a signal does what another one on its actuator does.

    Where motion is given a gain, an offset or a delay of a measured effort is one of the actuator,
    a force offset and a delay of the command; open loop from rest, so is the delay of the only
    measurement.
    """
    if effect.element is not Element.SIGNAL:
        return False
    name = next((n for n in told.compare if f"{effect.target}.".startswith(f"{n}.")), "")
    if name and told.compare[name].actuator:
        return True
    return anywhere(effect).columns == 0 and len(_outputs(told)) == 1
