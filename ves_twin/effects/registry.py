"""EFFECTS: every kind of effect by name, and effects from and to the tables of a file."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.plugins import Registry, lacks
from ves_twin.effects import (
    arm,
    computers,
    cylinder,
    deployed,
    force_sensor,
    geometry,
    payload,
    supply,
    timing,
    transducer,
    valve,
)
from ves_twin.effects.effect import Effect

_KINDS: tuple[type[Effect], ...] = (
    valve.ValveNull,
    valve.ValveGain,
    valve.ValveDeadband,
    valve.ValveLag,
    cylinder.CoulombFriction,
    cylinder.CylinderViscous,
    cylinder.PistonLeakage,
    cylinder.OilAir,
    supply.SupplyPressure,
    supply.SupplyDroop,
    transducer.LengthOffset,
    transducer.LengthScale,
    geometry.AnchorPosition,
    geometry.BaseTilt,
    geometry.HoseStiffness,
    geometry.LegBending,
    force_sensor.SensorGain,
    force_sensor.SensorCrossTalk,
    force_sensor.SensorDrift,
    force_sensor.SensorMounting,
    force_sensor.SensorLag,
    payload.PayloadMass,
    payload.LinkMass,
    payload.LinkCentre,
    arm.JointFriction,
    arm.JointViscous,
    arm.RotorInertia,
    arm.CableSpring,
    arm.TorqueConstant,
    arm.EncoderOffset,
    timing.TransducerDelay,
    timing.ValveDelay,
    timing.SensorDelay,
    timing.DriveDelay,
    deployed.LegGain,
    deployed.LegRateGain,
    deployed.FilterEdge,
    deployed.CommandLimit,
    deployed.ServoGain,
    computers.ModelMass,
    computers.StaleGravity,
)


def _problem(loaded: object) -> str | None:
    """What an installed class lacks to be a kind of effect."""
    wrong = lacks(Effect)(loaded)
    absent = [name for name in _DECLARED if not hasattr(loaded, name)]
    return wrong or (f"lacks {', '.join(absent)}" if absent else None)


_DECLARED = ("kind", "targets", "magnitudes", "channels", "source")

EFFECTS: Registry[type[Effect]] = Registry(
    "ves_twin.effects", {kind.kind: kind for kind in _KINDS}, _problem
)
"""Kind -> class; installed packages add kinds by entry points of this group."""


def build_effect(kind: str, target: str, values: Mapping[str, object]) -> Effect:
    """An effect by names.

    Raises:
        UnknownNameError: no such kind, target or magnitude; says the nearest one.
        InvalidInputError: a magnitude out of bounds.
    """
    if kind not in EFFECTS:
        raise UnknownNameError("effect", kind, EFFECTS)
    known = [magnitude.name for magnitude in EFFECTS[kind].magnitudes]
    for name in values:
        if name not in known:
            raise UnknownNameError(f"magnitude of {kind}", name, known)
    return EFFECTS[kind](target, **values)


def parse_effects(table: Mapping[str, object]) -> tuple[Effect, ...]:
    """Effects of a file's table: kind, then target, then magnitudes.

    Both `[effects.length_offset."leg.3"] offset = 0.001` and the dotted key
    `effects.length_offset.leg.3.offset` are understood.

    Raises:
        UnknownNameError: no such kind, target or magnitude.
        InvalidInputError: something that is not a table, or a magnitude out of bounds.
    """
    found: dict[tuple[str, str], dict[str, object]] = {}
    for path, value in _leaves(table, ()):
        kind, *target, name = ".".join(path).split(".")
        if kind not in EFFECTS:
            raise UnknownNameError("effect", kind, EFFECTS)
        if not target:
            raise InvalidInputError(f"effects.{kind}", value, "a target and its magnitudes")
        found.setdefault((kind, ".".join(target)), {})[name] = value
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
