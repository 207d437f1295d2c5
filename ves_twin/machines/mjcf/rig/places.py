"""place_of, carries, typical_speed, typical_span: a target as a place, and its typical sizes."""

from __future__ import annotations

from dataclasses import replace

import mujoco

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.units import to_si
from ves_twin.effects.clock import CLOCK
from ves_twin.effects.effect import Effect
from ves_twin.effects.element import Element
from ves_twin.effects.place import Place
from ves_twin.effects.row import Anywhere
from ves_twin.machines.mjcf.parts.chain import chain
from ves_twin.machines.mjcf.parts.joint_units import joint_units
from ves_twin.machines.mjcf.parts.servo import FILTERS, is_servo
from ves_twin.machines.mjcf.rig.description import Mode, RigDescription, Span

SINGLE = (int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE))
"""Joints that effects of joints are made for."""

ARM = 3
"""Joints in a row from which on the body at their end is that of an arm."""

SOFTEST = 1e-3
"""Of the typical effort over the typical travel: a stated spring is not taken for a softer one."""


def place_of(effect: Effect, told: RigDescription, model: mujoco.MjModel) -> Place:
    """The place of an effect of a kind that a machine of an MJCF model can have.

    Raises:
        UnknownNameError: no such part or signal; says the nearest one.
        InvalidInputError: a joint that neither turns nor slides, or no typical sizes.
    """
    kind, target, on = effect.kind, effect.target, anywhere(effect)
    element = on.element
    if element is Element.SIGNAL:
        return _signal(kind, target, on, told)
    if element is Element.WORLD:
        _known("axis of the world", target, ("x", "y"))
        return Place(element, target)
    if element is Element.LOG:
        _known("part of a log", target, (CLOCK,))
        return Place(element, target)
    if element is Element.BODY:
        name, _, axis = target.rpartition(".") if on.axis else (target, "", "")
        if on.axis and axis not in tuple("xyz"):
            raise InvalidInputError(f"target of {kind}", target, "a body and an axis, as tool.x")
        _known("body", name, {model.body(i).name for i in range(1, model.nbody)})
        at = model.body(name).id
        return Place(element, target, mass=float(model.body_mass[at]), carries=carries(model, at))
    if element is Element.ACTUATOR:
        return _actuator(effect, told, model)
    if element is Element.TENDON:
        return _tendon(target, told, model)
    return _joint(effect.parts[0], told, model)


def carries(model: mujoco.MjModel, body: int) -> bool:
    """Whether no body is behind one, and ARM joints or more before it."""
    joints = sum(int(model.body_jntnum[at]) for at in chain(model, body))
    return joints >= ARM and body not in model.body_parentid


def anywhere(effect: Effect) -> Anywhere:
    """What an effect's kind is on any machine.

    Raises:
        InvalidInputError: a kind of VES II alone.
    """
    if effect.anywhere is None:
        raise InvalidInputError(effect.kind, effect.target, "a kind that any machine can have")
    return effect.anywhere


def typical_speed(joint: str, told: RigDescription, model: mujoco.MjModel) -> float:
    """Typical speed of a joint [m/s or rad/s].

    Raises:
        InvalidInputError: the file says none.
    """
    _, unit = joint_units(model, joint)
    span = told.typical.joint.get(joint, Span())
    return _positive(span.speed, unit, f"typical.joint.{joint}.speed")


def typical_span(signal: str, told: RigDescription) -> float:
    """Typical range of a signal [its unit]: its own, or that of its joint; 0 if nobody says."""
    unit, own = told.signals[signal].unit, told.typical.signal.get(signal)
    if own is not None:
        return to_si(own.span, unit, f"typical.signal.{signal}.span")
    compared = told.compare.get(signal)
    if compared is None or not compared.joint:
        return 0.0
    joint = told.typical.joint.get(compared.joint, Span())
    value = joint.travel if compared.of == "position" else joint.speed
    return to_si(value, unit, f"typical.joint.{compared.joint}")


def driven_joint(model: mujoco.MjModel, actuator: str | int) -> str:
    """The joint that an actuator drives; empty where it drives a tendon or a site."""
    part = model.actuator(actuator)
    on_joint = int(part.trntype[0]) == int(mujoco.mjtTrn.mjTRN_JOINT)
    return str(model.joint(int(part.trnid[0])).name) if on_joint else ""


def _joint(target: str, told: RigDescription, model: mujoco.MjModel) -> Place:
    _known("joint", target, {model.joint(i).name for i in range(model.njnt)})
    found = int(model.jnt_type[model.joint(target).id])
    if found not in SINGLE:
        raise InvalidInputError(f"joint {target}", "a free or ball joint", "a hinge or a slide")
    hinge = found == SINGLE[0]
    span = told.typical.joint.get(target, Span())
    what = f"typical.joint.{target}"
    effort = _positive(span.effort, "N*m" if hinge else "N", f"{what}.effort")
    travel = _positive(span.travel, "rad" if hinge else "m", f"{what}.travel")
    stiffness = float(model.jnt_stiffness[model.joint(target).id])
    stated = {
        p.joint for p in told.parameters if p.attribute == "stiffness" and p.value is not None
    }
    if target in stated:  # a spring that was fitted away, all of it or nearly, is still one
        stiffness = max(stiffness, SOFTEST * effort / travel)
    return Place(
        Element.JOINT,
        target,
        hinge=hinge,
        effort=effort,
        speed=typical_speed(target, told, model),
        travel=travel,
        stiffness=stiffness,
    )


def _actuator(effect: Effect, told: RigDescription, model: mujoco.MjModel) -> Place:
    """With the command that its joint's typical effort takes, 0 where the file says none."""
    target, *others = effect.parts
    for name in effect.parts:
        _known("actuator", name, {model.actuator(i).name for i in range(model.nu)})
    imposed = () if told.drive.mode is Mode.MOTION else told.drive.imposed
    for joint in (driven_joint(model, name) for name in others):
        if not joint or joint in imposed:
            expected = "a drive whose command is known: of a joint that is not imposed"
            raise InvalidInputError(f"target of {effect.kind}", effect.target, expected)
    actuator, joint = model.actuator(target), driven_joint(model, target)
    span, gain = told.typical.joint.get(joint, Span()), float(actuator.gainprm[0])
    units = joint_units(model, joint) if joint else ("", "")
    integrated = told.drive.mode is not Mode.MOTION
    lag = float(actuator.dynprm[0]) if int(actuator.dyntype[0]) in FILTERS and integrated else 0.0
    place = Place(Element.ACTUATOR, target, hinge=units[0] == "rad", gain=gain, lag=lag)
    if integrated and is_servo(model, int(actuator.id)):
        travel = to_si(span.travel, units[0], f"typical.joint.{joint}.travel")
        return replace(place, stiffness=gain, effort=travel, unit=units[0])
    exerted = abs(float(actuator.gear[0]) * gain)
    if not span.effort or not exerted:
        return place
    unit = "N*m" if place.hinge else "N"
    effort = _positive(span.effort, unit, f"typical.joint.{joint}.effort")
    return replace(place, effort=effort / exerted, unit=unit if exerted == 1.0 else "1")


def _tendon(target: str, told: RigDescription, model: mujoco.MjModel) -> Place:
    """What is typical of a sum of joints: the least effort, the sums of speeds and travels."""
    _known("tendon", target, {model.tendon(i).name for i in range(model.ntendon)})
    parts = tendon_joints(model, target)
    places = [_joint(joint, told, model) for joint, _ in parts]
    if not places or len({p.hinge for p in places}) > 1:
        expected = "a fixed tendon over joints that all turn, or all slide"
        raise InvalidInputError(f"tendon {target}", [joint for joint, _ in parts], expected)
    shares = [abs(share) for _, share in parts]
    return Place(
        Element.TENDON,
        target,
        hinge=places[0].hinge,
        effort=min(p.effort / s for p, s in zip(places, shares, strict=True)),
        speed=sum(s * p.speed for p, s in zip(places, shares, strict=True)),
        travel=sum(s * p.travel for p, s in zip(places, shares, strict=True)),
        stiffness=float(model.tendon_stiffness[model.tendon(target).id]),
    )


def tendon_joints(model: mujoco.MjModel, tendon: str | int) -> list[tuple[str, float]]:
    """Joints of a fixed tendon with their coefficients; none of a spatial one."""
    number = model.tendon(tendon).id
    first, count = int(model.tendon_adr[number]), int(model.tendon_num[number])
    rows = range(first, first + count)
    if any(int(model.wrap_type[k]) != int(mujoco.mjtWrap.mjWRAP_JOINT) for k in rows):
        return []
    return [(model.joint(int(model.wrap_objid[k])).name, float(model.wrap_prm[k])) for k in rows]


def _signal(kind: str, target: str, on: Anywhere, told: RigDescription) -> Place:
    count, parts = on.columns, target.split(".")
    if not count:
        groups = {signal.partition(".")[0] for signal in told.signals}
        _known("signal", target, {*told.signals, *groups})
        return Place(Element.SIGNAL, target, unit="s")
    if target in told.signals:
        example = ".".join([target, *map(str, range(1, count + 1))])
        expected = f"the number of a column behind the signal: {example}"
        raise InvalidInputError(f"target of {kind}", target, expected)
    name = ".".join(parts[:-count])
    _known("signal", name, told.signals)
    column = told.signals[name]
    for number in parts[len(parts) - count :]:
        if not number.isdigit() or not 1 <= int(number) <= len(column.columns):
            raise InvalidInputError(
                f"target of {kind}", target, f"columns of {name} from 1 to {len(column.columns)}"
            )
    span = _positive(typical_span(name, told), column.unit, f"typical.signal.{name}.span")
    place = Place(Element.SIGNAL, target, unit=column.unit, span=span)
    if not on.transient:
        return place
    if told.drift is None:
        raise InvalidInputError("drift", None, "a table with the end of the stretch it spans")
    drift = told.drift
    return replace(place, begin=drift.begin, end=drift.end, terms=drift.terms)


def _known(what: str, name: str, there: object) -> None:
    if name not in there:  # type: ignore[operator]
        raise UnknownNameError(what, name, there)  # type: ignore[arg-type]


def _positive(value: float | str, unit: str, what: str) -> float:
    number = to_si(value, unit, what)
    if number <= 0.0:
        raise InvalidInputError(what, value, f"a typical size in {unit}, above zero")
    return number
