"""EFFECTS: every kind of effect of any machine by name; effects from and to tables of files."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import fields
from types import ModuleType

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.plugins import Registry, lacks
from ves_twin.effects import (
    actuators,
    bodies,
    clock,
    couplings,
    friction,
    hydraulics,
    joints,
    presliding,
    programs,
    recorder,
    ripple,
    sensors,
    servos,
    structure,
    transducers,
)
from ves_twin.effects.bodies import MassCentre
from ves_twin.effects.effect import Effect
from ves_twin.effects.element import Element
from ves_twin.effects.row import ALL_LEGS, JOINTS, LEGS, LINKS
from ves_twin.effects.sensors import CrossTalk

_CATALOGUE = (
    *(transducers, joints, friction, presliding, ripple, couplings, hydraulics, structure),
    *(actuators, servos, bodies, clock, sensors, programs, recorder),
)

RENAMED = {
    "cable_spring": ("joint_spring", JOINTS),
    "cylinder_viscous": ("viscous_friction", LEGS),
    "drive_delay": ("actuator_delay", ("arm",)),
    "joint_friction": ("coulomb_friction", JOINTS),
    "joint_viscous": ("viscous_friction", JOINTS),
    "link_centre": ("mass_centre", MassCentre.targets),
    "link_mass": ("body_mass", LINKS),
    "sensor_cross_talk": ("cross_talk", CrossTalk.targets),
    "torque_constant": ("actuator_gain", JOINTS),
    "valve_delay": ("actuator_delay", ALL_LEGS),
}
"""Names that files on VES II of earlier versions have -> today's kind, and the targets meant."""

RENAMED_ANYWHERE = {"sensor_drift": "sensor_wander"}
"""The same of files of other machines; on VES II `sensor_drift` is a steady rate."""


def _kinds_of(module: ModuleType) -> Iterable[type[Effect]]:
    """Effects that a module defines, in the order of its text."""
    for found in vars(module).values():
        own = getattr(found, "__module__", "") == module.__name__
        if own and isinstance(found, type) and issubclass(found, Effect):
            yield found


def _problem(loaded: object) -> str | None:
    """What an installed class lacks to be a kind of effect."""
    wrong = lacks(Effect)(loaded)
    if wrong or getattr(loaded, "anywhere", None) is not None:
        return wrong
    absent = [name for name in _DECLARED if not getattr(loaded, name, None)]
    whole = getattr(loaded, "rows", ()) and hasattr(loaded, "kind")
    return f"lacks {', '.join(absent)}" if absent and not whole else None


_DECLARED = ("kind", "targets", "magnitudes", "channels", "source")

EFFECTS: Registry[type[Effect]] = Registry(
    "ves_twin.effects",
    {kind.kind: kind for module in _CATALOGUE for kind in _kinds_of(module)},
    _problem,
    also="ves_twin.rig_effects",
    renamed={name: kind for name, (kind, _) in RENAMED.items()},
)
"""Kind -> class; installed packages add kinds by entry points of either group."""


def kind_on_ves2(name: str) -> type[Effect]:
    """A kind that VES II can have.

    Raises:
        UnknownNameError: no such kind; says the nearest one.
    """
    if name not in EFFECTS or not EFFECTS[name].rows:
        raise UnknownNameError("effect", name, [k for k, v in EFFECTS.items() if v.rows])
    return EFFECTS[name]


def kind_anywhere(name: str) -> type[Effect]:
    """A kind that a machine of an MJCF model can have; an earlier name is understood.

    Raises:
        UnknownNameError: no such kind; says the nearest one.
    """
    name = RENAMED_ANYWHERE.get(name, name)
    if name not in EFFECTS or EFFECTS[name].anywhere is None:
        raise UnknownNameError("effect", name, [k for k, v in EFFECTS.items() if v.anywhere])
    return EFFECTS[name]


def attributes() -> dict[tuple[Element, str], type[Effect]]:
    """Attributes of an MJCF model that [[parameters]] may name, by what has them -> kind."""
    found: dict[tuple[Element, str], type[Effect]] = {}
    for kind in map(EFFECTS.__getitem__, EFFECTS.built_in):
        if kind.anywhere and kind.anywhere.attribute:
            element, name = kind.anywhere.element, kind.anywhere.attribute.name
            names = [f"{name}_{axis}" for axis in "xyz"] if kind.anywhere.axis else [name]
            found |= {(element, name): kind for name in names}
    return found


def targets_of(name: str) -> tuple[str, ...]:
    """Targets on VES II that a kind by this name has where a file does not say which."""
    kind = kind_on_ves2(name)
    return RENAMED[name][1] if name in RENAMED else kind.rows[0].targets


def causes_of_today(names: Iterable[str]) -> list[str]:
    """Causes of VES II, each a kind or kind@target, by the kinds' names of today."""
    found = []
    for name in names:
        kind, targets = RENAMED.get(name, ("", ()))
        found += [f"{kind}@{one}" for one in targets] if kind else [label_of_today(name)]
    return found


def label_of_today(label: str) -> str:
    """kind@target or kind@target:size by today's name, where VES II had that kind there."""
    earlier, _, place = label.partition("@")
    kind, targets = RENAMED.get(earlier, ("", ()))
    return f"{kind}@{place}" if place.partition(":")[0] in targets else label


def causes_anywhere(names: Iterable[str]) -> list[str]:
    """The same of machines of an MJCF model."""
    parts = [name.partition("@") for name in names]
    return [RENAMED_ANYWHERE.get(kind, kind) + at + target for kind, at, target in parts]


def build_effect(kind: str, target: str, values: Mapping[str, object]) -> Effect:
    """An effect on VES II by names.

    Raises:
        UnknownNameError: no such kind, target or size; says the nearest one.
        InvalidInputError: a size out of bounds.
    """
    found = _built(kind_on_ves2(kind), target, values)
    found.check()
    return found


def build_anywhere(kind: str, target: str, values: Mapping[str, object]) -> Effect:
    """An effect on a machine of an MJCF model by names; raises as `build_effect`."""
    return _built(kind_anywhere(kind), target, values)


def _built(kind: type[Effect], target: str, values: Mapping[str, object]) -> Effect:
    known = [field.name for field in fields(kind) if field.name != "target"]
    for name in values:
        if name not in known:
            raise UnknownNameError(f"size of {kind.kind}", name, known)
    return kind(target, **values)


def parse_effects(table: Mapping[str, object]) -> tuple[Effect, ...]:
    """Effects on VES II of a file's table: kind, then target, then sizes.

    Both `[effects.length_offset."leg.3"] offset = 0.001` and the dotted key
    `effects.length_offset.leg.3.offset` are understood.

    Raises:
        UnknownNameError: no such kind, target or size.
        InvalidInputError: something that is not a table, or a size out of bounds.
    """
    found: dict[tuple[str, str], dict[str, object]] = {}
    for path, value in _leaves(table, ()):
        name, *target, size = ".".join(path).split(".")
        kind = kind_on_ves2(name).kind
        if not target:
            raise InvalidInputError(f"effects.{name}", value, "a target and its sizes")
        found.setdefault((kind, ".".join(target)), {})[size] = value
    return tuple(build_effect(kind, target, found[kind, target]) for kind, target in sorted(found))


def effects_table(effects: Iterable[Effect]) -> dict[str, dict[str, dict[str, float]]]:
    """The table that `parse_effects` reads."""
    table: dict[str, dict[str, dict[str, float]]] = {}
    for effect in effects:
        table.setdefault(effect.kind, {})[effect.target] = effect.values
    return table


def _leaves(
    node: Mapping[str, object], path: tuple[str, ...]
) -> Iterable[tuple[tuple[str, ...], object]]:
    for key, child in node.items():
        here = (*path, str(key))
        if isinstance(child, Mapping):
            yield from _leaves(child, here)
        else:
            if len(here) < 2:
                raise InvalidInputError(f"effects.{key}", child, "a table of targets")
            yield here, child
